// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/rotation_grid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "core/geometry/pose.hpp"

namespace calibrd {
namespace {

TEST(RotationGrid, LeavesNoOrientationFurtherThanThirtyFiveDegreesAway) {
  const auto rotations = even_rotations(600);
  ASSERT_EQ(rotations.size(), 600U);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double furthest = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Matrix3d any =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized()
            .toRotationMatrix();
    double nearest = 10;
    for (const Eigen::Matrix3d& R : rotations)
      nearest = std::min(nearest, log_so3(R.transpose() * any).norm());
    furthest = std::max(furthest, nearest);
  }
  EXPECT_LT(furthest, 35 * 0.01745);
}

TEST(RotationGrid, HoldsRotations) {
  for (const Eigen::Matrix3d& R : even_rotations(50)) {
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12));
  }
}

}  // namespace
}  // namespace calibrd
