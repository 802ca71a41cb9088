// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/primitives.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/core/robot/mesh_checks.hpp"

namespace calibrd {
namespace {

using std::numbers::pi;

/// Signed distances (outside positive) of `distance` over vertices, edge middles and triangle middles.
template <class Distance>
std::pair<double, double> distance_range(const TriangleMesh& mesh, Distance distance) {
  double inmost = 1e9, outmost = -1e9;
  const auto look = [&](const Eigen::Vector3f& point) {
    inmost = std::min(inmost, distance(point.cast<double>()));
    outmost = std::max(outmost, distance(point.cast<double>()));
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f p = mesh.vertices[a], q = mesh.vertices[b], r = mesh.vertices[c];
    for (const Eigen::Vector3f& point : {p, Eigen::Vector3f((p + q) / 2), Eigen::Vector3f((q + r) / 2),
                                         Eigen::Vector3f((r + p) / 2), Eigen::Vector3f((p + q + r) / 3)})
      look(point);
  }
  return {inmost, outmost};
}

TEST(Primitives, SphereLiesWithinATenthOfAMillimetreHalfInHalfOut) {
  for (const double radius : {0.02, 0.1, 0.5}) {
    const auto sphere = make_sphere(radius);
    const auto [inmost, outmost] =
        distance_range(sphere, [=](const Eigen::Vector3d& p) { return p.norm() - radius; });
    EXPECT_LT(outmost, 1e-4);
    EXPECT_GT(inmost, -1e-4);
    EXPECT_GT(outmost, 0);
    EXPECT_LT(inmost, 0);
    EXPECT_TRUE(test::is_closed(sphere));
    EXPECT_NEAR(test::volume(sphere) / (4 * pi / 3 * radius * radius * radius), 1, 5e-3);
  }
}

TEST(Primitives, CylinderWallLiesWithinATenthOfAMillimetreHalfInHalfOut) {
  for (const double radius : {0.02, 0.1, 0.5}) {
    const auto cylinder = make_cylinder(radius, 0.3);
    const auto from_wall = [=](const Eigen::Vector3d& p) {
      const bool on_wall = p.head<2>().norm() > 0.9 * radius;
      return on_wall ? p.head<2>().norm() - radius : 0.0;
    };
    const auto [inmost, outmost] = distance_range(cylinder, from_wall);
    EXPECT_LT(outmost, 1e-4);
    EXPECT_GT(inmost, -1e-4);
    EXPECT_TRUE(test::is_closed(cylinder));
    EXPECT_NEAR(test::volume(cylinder) / (pi * radius * radius * 0.3), 1, 5e-3);
    EXPECT_NEAR(test::bounds(cylinder).sizes().z(), 0.3F, 1e-6F);
  }
}

TEST(Primitives, BoxIsExact) {
  const auto box = make_box({0.1, 0.2, 0.3});
  EXPECT_TRUE(test::is_closed(box));
  EXPECT_NEAR(test::volume(box), 0.006, 1e-9);
  EXPECT_NEAR(surface_area(box), 0.22, 1e-7);
  EXPECT_TRUE(test::bounds(box).max().isApprox(Eigen::Vector3f(0.05F, 0.1F, 0.15F)));
}

}  // namespace
}  // namespace calibrd
