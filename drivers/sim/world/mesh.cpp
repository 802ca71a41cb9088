// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace calibrd::sim {
namespace {

/// A surface of revolution about z: `profile` lists (radius, z) from the lower pole to the upper one.
Mesh revolve(const std::vector<Eigen::Vector2d>& profile, int sides) {
  Mesh mesh;
  const auto ring_size = static_cast<std::uint32_t>(sides);
  for (const auto& point : profile)
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.vertices.push_back(
          Eigen::Vector3d(point.x() * std::cos(angle), point.x() * std::sin(angle), point.y()).cast<float>());
    }
  for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring)
    for (std::uint32_t i = 0; i < ring_size; ++i) {
      const std::uint32_t a = ring * ring_size + i, b = ring * ring_size + (i + 1) % ring_size;
      mesh.triangles.push_back({a, b, b + ring_size});
      mesh.triangles.push_back({a, b + ring_size, a + ring_size});
    }
  mesh.solid = is_solid(mesh);
  return mesh;
}

}  // namespace

bool is_solid(const Mesh& mesh) {
  std::map<std::array<float, 3>, int> points;  // files repeat a point for each of its triangles
  const auto point = [&](std::uint32_t vertex) {
    const Eigen::Vector3f& v = mesh.vertices[vertex];
    return points.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(points.size())).first->second;
  };
  std::map<std::pair<int, int>, int> balance;  // of an edge: times up less times down
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const std::array corners{point(t[0]), point(t[1]), point(t[2])};
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = corners[i], to = corners[(i + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : from > to ? -1 : 0;
    }
    volume += mesh.vertices[t[0]].cast<double>().dot(
        mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
  }
  return volume > 0 && std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

void append(Mesh& mesh, const Mesh& part) {
  mesh.solid = part.solid && (mesh.solid || mesh.triangles.empty());
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles) mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

Mesh make_box(const Eigen::Vector3d& size_m) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back((0.5 * size_m)
                                .cwiseProduct(Eigen::Vector3d((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                                              (corner & 4) != 0 ? 1 : -1))
                                .cast<float>());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  mesh.solid = is_solid(mesh);
  return mesh;
}

Mesh make_cylinder(double radius_m, double length_m, int sides) {
  const double half = 0.5 * length_m;
  return revolve({{0, -half}, {radius_m, -half}, {radius_m, half}, {0, half}}, sides);
}

Mesh make_capsule(double radius_m, double length_m, int sides) {
  constexpr int kRings = 5;
  std::vector<Eigen::Vector2d> profile;
  for (int end : {-1, 1})
    for (int i = 0; i <= kRings; ++i) {
      const double step = 0.5 * std::numbers::pi * (end < 0 ? i : kRings - i) / kRings;
      profile.emplace_back(radius_m * std::sin(step), end * (0.5 * length_m + radius_m * std::cos(step)));
    }
  return revolve(profile, sides);
}

}  // namespace calibrd::sim
