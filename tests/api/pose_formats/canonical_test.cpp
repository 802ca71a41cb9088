// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "api/pose_formats/euler_angles.hpp"
#include "core/geometry/canonical_rotation.hpp"
#include "tests/api/pose_formats/hard_poses.hpp"

namespace calibrd::api {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Matrix3d turn(double rad, const Vector3d& axis) { return AngleAxisd(rad, axis).toRotationMatrix(); }
const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

/// Every element off by rounding.
Matrix3d shaken(Matrix3d rotation, unsigned seed) {
  std::mt19937 dice(seed);
  std::uniform_real_distribution<double> noise(-2e-16, 2e-16);
  for (double& element : rotation.reshaped()) element += noise(dice);
  return rotation;
}

TEST(CanonicalQuaternion, HasAPositiveRealPartOrAPositiveFirstComponent) {
  for (const auto& T : test::all_poses()) {
    const auto q = canonical_quaternion(T.linear());
    EXPECT_NEAR(q.norm(), 1, 1e-12);
    EXPECT_GE(q.w(), 0);
    if (q.w() > 0) continue;
    const auto first = std::abs(q.x()) > 1e-12 ? q.x() : std::abs(q.y()) > 1e-12 ? q.y() : q.z();
    EXPECT_GT(first, 0);
  }
}

TEST(CanonicalQuaternion, RoundingDoesNotTurnAHalfTurnRound) {
  for (const auto& axis : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, -1), Vector3d(0, 0.6, -0.8),
                           Vector3d(-0.6, 0, 0.8)}) {
    const auto q = canonical_quaternion(turn(kPi, axis));
    const Vector3d v = canonical_rotation_vector(turn(kPi, axis));
    for (unsigned seed = 0; seed < 50; ++seed) {
      EXPECT_LT((canonical_quaternion(shaken(turn(-kPi, axis), seed)).coeffs() - q.coeffs()).norm(), 1e-9);
      EXPECT_LT((canonical_rotation_vector(shaken(turn(-kPi, axis), seed)) - v).norm(), 1e-9);
    }
  }
  EXPECT_LT((canonical_rotation_vector(turn(kPi, -kY)) - kPi * kY).norm(), 1e-12);
}

TEST(CanonicalRotationVector, IsAtMostAHalfTurnAndZeroForNone) {
  for (const auto& T : test::all_poses())
    EXPECT_LE(canonical_rotation_vector(T.linear()).norm(), kPi + 1e-12);
  EXPECT_EQ(canonical_rotation_vector(Matrix3d::Identity()).norm(), 0);
}

TEST(EulerAngles, StayInTheirRanges) {
  for (const auto& T : test::all_poses()) {
    for (const auto& angles : {zyx_angles(T.linear()), xyz_angles(T.linear())})
      EXPECT_LE(std::abs(angles.second), kPi / 2 + 1e-12);
    const auto zyz = zyz_angles(T.linear());
    EXPECT_GE(zyz.second, 0);
    EXPECT_LE(zyz.second, kPi);
    for (const auto& angles : {zyx_angles(T.linear()), xyz_angles(T.linear()), zyz})
      for (const double angle : {angles.first, angles.third}) {
        EXPECT_GT(angle, -kPi);
        EXPECT_LE(angle, kPi);
        EXPECT_FALSE(angle == 0 && std::signbit(angle));
      }
  }
}

void expect_angles(const EulerAngles& told, double first, double second) {
  EXPECT_NEAR(told.first, first, 1e-9);
  EXPECT_NEAR(told.second, second, 1e-9);
  EXPECT_EQ(told.third, 0);
}

/// The sum or difference of first and third is all that is left of them at the lock.
TEST(EulerAngles, ThirdIsZeroAtTheGimbalLockAndARoundingErrorBesideIt) {
  for (const double gap : {0.0, 1e-16, -1e-14, 1e-12, -1e-11})
    for (unsigned seed = 0; seed < 10; ++seed) {
      const double up = kPi / 2 + gap, down = -kPi / 2 + gap;
      expect_angles(zyx_angles(shaken(turn(0.7, kZ) * turn(up, kY) * turn(0.2, kX), seed)), 0.5, kPi / 2);
      expect_angles(zyx_angles(shaken(turn(0.7, kZ) * turn(down, kY) * turn(0.2, kX), seed)), 0.9, -kPi / 2);
      expect_angles(xyz_angles(shaken(turn(0.7, kX) * turn(up, kY) * turn(0.2, kZ), seed)), 0.9, kPi / 2);
      expect_angles(xyz_angles(shaken(turn(0.7, kX) * turn(down, kY) * turn(0.2, kZ), seed)), 0.5, -kPi / 2);
      expect_angles(zyz_angles(shaken(turn(0.7, kZ) * turn(gap, kY) * turn(0.2, kZ), seed)), 0.9, 0);
      expect_angles(zyz_angles(shaken(turn(0.7, kZ) * turn(kPi + gap, kY) * turn(0.2, kZ), seed)), 0.5, kPi);
    }
}

TEST(EulerAngles, AreThoseOfTheTurnAMillionthOfARadianBesideTheLock) {
  const double near = kPi / 2 - 1e-6;
  const auto zyx = zyx_angles(turn(0.7, kZ) * turn(near, kY) * turn(0.2, kX));
  EXPECT_NEAR(zyx.first, 0.7, 1e-9);
  EXPECT_NEAR(zyx.third, 0.2, 1e-9);
  const auto zyz = zyz_angles(turn(0.7, kZ) * turn(1e-6, kY) * turn(0.2, kZ));
  EXPECT_NEAR(zyz.first, 0.7, 1e-9);
  EXPECT_NEAR(zyz.third, 0.2, 1e-9);
}

TEST(EulerAngles, OfAHalfTurnArePlus180) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_NEAR(zyx_angles(shaken(turn(-kPi, kZ), seed)).first, kPi, 1e-12);
    EXPECT_NEAR(zyx_angles(shaken(turn(-kPi, kX), seed)).third, kPi, 1e-12);
    EXPECT_NEAR(xyz_angles(shaken(turn(-kPi, kX), seed)).first, kPi, 1e-12);
  }
}

}  // namespace
}  // namespace calibrd::api
