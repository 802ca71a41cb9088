// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/distance_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace calibrd {
namespace {

constexpr float kVoxel_m = 0.02F;

std::vector<Eigen::Vector3f> some_points() {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> place(-0.4F, 0.4F);
  std::vector<Eigen::Vector3f> points(40);
  for (auto& p : points) p = {place(random), place(random), place(random)};
  return points;
}

float nearest_m(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& q) {
  float nearest = 1e9F;
  for (const auto& p : points) nearest = std::min(nearest, (p - q).norm());
  return nearest;
}

TEST(DistanceField, IsTheDistanceToTheNearestPointWithinAVoxel) {
  const auto points = some_points();
  const DistanceField field(points, kVoxel_m, 0.2F);
  std::mt19937_64 random(6);
  std::uniform_real_distribution<float> place(-0.55F, 0.55F);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f q(place(random), place(random), place(random));
    EXPECT_NEAR(field.at(q).distance_m, nearest_m(points, q), 1.5F * kVoxel_m) << q.transpose();
  }
}

TEST(DistanceField, GradientIsTheSlopeOfTheDistance) {
  const DistanceField field(some_points(), kVoxel_m, 0.2F);
  constexpr float kStep_m = 1e-4F;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> place(-0.9F, 0.9F);  // outside of the grid, too
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f q(place(random), place(random), place(random));
    const Eigen::Vector3f gradient = field.at(q).gradient;
    Eigen::Vector3f slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3f step = kStep_m * Eigen::Vector3f::Unit(axis);
      slope[axis] = (field.at(q + step).distance_m - field.at(q - step).distance_m) / (2 * kStep_m);
    }
    compared += (slope - gradient).norm() < 0.05F ? 1 : 0;  // not across the sides of cells
  }
  EXPECT_GT(compared, 250);
}

TEST(DistanceField, GrowsOutsideOfItsGrid) {
  const std::vector<Eigen::Vector3f> one{Eigen::Vector3f(0, 0, 0)};
  const DistanceField field(one, kVoxel_m, 0.1F);
  EXPECT_NEAR(field.at({0, 0, 2}).distance_m, 2, 2 * kVoxel_m);
  EXPECT_NEAR(field.at({0, 0, 2}).gradient.z(), 1, 0.01);
}

}  // namespace
}  // namespace calibrd
