// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace calibrd {
namespace {

constexpr double kSurfaceErrorM = 1e-4;

/// Vertices at the radius returned, on facets that span `half_angle_rad` from middle to vertex, are as far
/// outside the true surface as the facet's middle is inside: r' - r = r - r' cos(half angle).
double balanced_radius(double radius_m, double half_angle_rad) {
  return 2 * radius_m / (1 + std::cos(half_angle_rad));
}

/// Even count of segments round a full circle for which balanced_radius() errs by less than kSurfaceErrorM;
/// r (h²/2) / 2 with h = spread · π/n.
std::uint32_t segments(double radius_m, double spread) {
  const double wanted = spread * std::numbers::pi * std::sqrt(radius_m / (4 * kSurfaceErrorM));
  return 2 * static_cast<std::uint32_t>(std::ceil(std::clamp(wanted, 24.0, 512.0) / 2));
}

Eigen::Vector3f on_circle(double radius_m, std::uint32_t step, std::uint32_t steps, double z_m) {
  const double angle = 2 * std::numbers::pi * step / steps;
  return Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), z_m).cast<float>();
}

/// Rings of `steps` vertices from bottom to top, closed by one vertex below and one above.
TriangleMesh close_rings(std::vector<Eigen::Vector3f> rings, std::uint32_t steps, float bottom_m,
                         float top_m) {
  TriangleMesh mesh{std::move(rings), {}};
  const auto ring_vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::uint32_t last_ring = ring_vertices - steps;
  const std::uint32_t south = ring_vertices, north = ring_vertices + 1;
  mesh.vertices.emplace_back(0.0F, 0.0F, bottom_m);
  mesh.vertices.emplace_back(0.0F, 0.0F, top_m);
  for (std::uint32_t step = 0; step < steps; ++step) {
    const std::uint32_t next = (step + 1) % steps;
    mesh.triangles.push_back({south, next, step});
    for (std::uint32_t ring = 0; ring < last_ring; ring += steps) {
      mesh.triangles.push_back({ring + step, ring + next, ring + steps + next});
      mesh.triangles.push_back({ring + step, ring + steps + next, ring + steps + step});
    }
    mesh.triangles.push_back({north, last_ring + step, last_ring + next});
  }
  return mesh;
}

}  // namespace

TriangleMesh make_box(const Eigen::Vector3d& size_m) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) ? 0.5 : -0.5, (corner & 2) ? 0.5 : -0.5,
                               (corner & 4) ? 0.5 : -0.5);
    mesh.vertices.emplace_back(sign.cwiseProduct(size_m).cast<float>());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh make_cylinder(double radius_m, double length_m) {
  const std::uint32_t steps = segments(radius_m, 1);
  const double radius = balanced_radius(radius_m, std::numbers::pi / steps);
  std::vector<Eigen::Vector3f> rings;
  for (const double z : {-length_m / 2, length_m / 2})
    for (std::uint32_t step = 0; step < steps; ++step) rings.push_back(on_circle(radius, step, steps, z));
  return close_rings(std::move(rings), steps, static_cast<float>(-length_m / 2),
                     static_cast<float>(length_m / 2));
}

TriangleMesh make_sphere(double radius_m) {
  // Facets at the equator are squares of side 2π/n: from middle to vertex √2 π/n.
  const std::uint32_t steps = segments(radius_m, std::numbers::sqrt2);
  const double radius = balanced_radius(radius_m, std::numbers::sqrt2 * std::numbers::pi / steps);
  const std::uint32_t bands = steps / 2;
  std::vector<Eigen::Vector3f> rings;
  for (std::uint32_t band = 1; band < bands; ++band) {
    const double angle = std::numbers::pi * band / bands;
    for (std::uint32_t step = 0; step < steps; ++step)
      rings.push_back(on_circle(radius * std::sin(angle), step, steps, -radius * std::cos(angle)));
  }
  return close_rings(std::move(rings), steps, static_cast<float>(-radius), static_cast<float>(radius));
}

}  // namespace calibrd
