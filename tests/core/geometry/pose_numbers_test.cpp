// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose_numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace calibrd {
namespace {

TEST(PoseNumbers, QuaternionIsReadScalarLast) {
  const std::vector<double> quarter_turn_about_z{1, 2, 3, 0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  const auto pose = pose_of_numbers(quarter_turn_about_z);
  ASSERT_TRUE(pose);
  EXPECT_TRUE((*pose * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1, 3, 3), 1e-12));
}

TEST(PoseNumbers, LengthOfAQuaternionDoesNotMatter) {
  const auto pose = pose_of_numbers(std::vector<double>{0, 0, 0, 0, 0, 5, 5});
  ASSERT_TRUE(pose);
  EXPECT_TRUE((*pose * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(PoseNumbers, LastRowMayHaveGoneThroughFloats) {
  EXPECT_TRUE(
      pose_of_numbers(std::vector<double>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1e-8, 0, 0, 0.9999999}));
}

TEST(PoseNumbers, MatricesAreReadRowMajor) {
  std::vector<double> numbers{0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3};
  const auto from_12 = pose_of_numbers(numbers);
  ASSERT_TRUE(from_12);
  EXPECT_TRUE(from_12->translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  numbers.insert(numbers.end(), {0, 0, 0, 1});
  const auto from_16 = pose_of_numbers(numbers);
  ASSERT_TRUE(from_16);
  EXPECT_TRUE(from_16->isApprox(*from_12));
}

TEST(PoseNumbers, RoundedRotationIsMadeExact) {
  const auto pose =
      pose_of_numbers(std::vector<double>{0.7071, -0.7071, 0, 0, 0.7071, 0.7071, 0, 0, 0, 0, 1, 0});
  ASSERT_TRUE(pose);
  EXPECT_TRUE((pose->linear().transpose() * pose->linear()).isIdentity(1e-14));
}

TEST(PoseNumbers, WhatIsNoPoseIsRefusedWithItsReason) {
  const auto error = [](const std::vector<double>& numbers) { return pose_of_numbers(numbers).error().code; };
  EXPECT_EQ(error({1, 2, 3}), PoseNumbersError::wrong_count);
  EXPECT_EQ(error({0, 0, 0, 0, 0, 0, 0}), PoseNumbersError::no_direction);
  EXPECT_EQ(error({1370, 730, 860, 0, 0, 0, 1}), PoseNumbersError::too_far);
  EXPECT_EQ(error({1, 0, 0, 0, 0, 1, 0, 730, 0, 0, 1, 0}), PoseNumbersError::too_far);
  EXPECT_EQ(error({0, 0, NAN, 0, 0, 0, 1}), PoseNumbersError::not_finite);
  EXPECT_EQ(error({-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}), PoseNumbersError::not_a_rotation);
  EXPECT_EQ(error({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}), PoseNumbersError::bad_last_row);
}

}  // namespace
}  // namespace calibrd
