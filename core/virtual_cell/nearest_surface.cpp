// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/nearest_surface.hpp"

#include <cmath>

namespace calibrd {
namespace {

struct Search {
  const TriangleMesh* mesh;
  Eigen::Vector3f point;
  std::optional<Eigen::Vector3f> found;
};

/// By the region of the triangle's plane that the point lies over (Ericson, Real-Time Collision Detection,
/// 5.1.5).
Eigen::Vector3f nearest_on_triangle(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                                    const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3f ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
              d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const float sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

/// Embree calls it for every triangle whose box lies within the radius; a nearer one narrows it.
bool look_at_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  const auto& [a, b, c] = search.mesh->triangles[arguments->primID];
  const auto& vertices = search.mesh->vertices;
  const Eigen::Vector3f nearest = nearest_on_triangle(search.point, vertices[a], vertices[b], vertices[c]);
  const float distance = (nearest - search.point).norm();
  if (!(distance < arguments->query->radius)) return false;
  arguments->query->radius = distance;
  search.found = nearest;
  return true;
}

}  // namespace

std::optional<Eigen::Vector3f> nearest_on_link(const LinkScenes::Surface& surface, const TriangleMesh& mesh,
                                               const Eigen::Vector3f& point_link, float within_m) {
  if (surface.bounds.squaredExteriorDistance(point_link) >= within_m * within_m) return std::nullopt;
  Search search{&mesh, point_link, std::nullopt};
  RTCPointQuery query{point_link.x(), point_link.y(), point_link.z(), 0, within_m};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(surface.scene, &query, &context, look_at_triangle, &search);
  return search.found;
}

}  // namespace calibrd
