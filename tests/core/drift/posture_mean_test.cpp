// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/posture_mean.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

constexpr double kOwn_m = 1e-3, kOwn_rad = 1e-3, kPose_m = 5e-4;

/// The robot looks displaced by `delta` (about the base's origin) where its surface is at `middle_base`.
PoseCheck looks_displaced(const Vector6d& delta, const Eigen::Vector3d& middle_base, double sigmas = 1) {
  PoseCheck check;
  check.enough_evidence = true;
  check.agrees = sigmas < 4;
  check.shift_sigmas = sigmas;
  check.middle_base = middle_base;
  check.turn_shift = shift_of_point(middle_base) * delta;
  check.pose_covariance.setZero();
  check.pose_covariance.diagonal().tail<3>().setConstant(kPose_m * kPose_m);
  Vector6d own;
  own << Eigen::Vector3d::Constant(kOwn_rad * kOwn_rad), Eigen::Vector3d::Constant(kOwn_m * kOwn_m);
  check.turn_shift_covariance = check.pose_covariance;
  check.turn_shift_covariance.diagonal() += own;
  return check;
}

Vector6d some_delta() {
  Vector6d delta;
  delta << 1e-3, -5e-4, 2e-4, 1e-3, 5e-4, -2e-3;
  return delta;
}

std::vector<double> joints(int posture) { return {0.3 * posture, -0.1}; }
Eigen::Vector3d place(int posture) { return {0.5 + 0.1 * (posture % 3), 0.1 * (posture % 5), 0.8}; }

PostureMean mean_of(int postures, const Vector6d& delta, double sigmas = 1) {
  PostureMean mean;
  double now_s = 0;
  for (int i = 0; i < postures; ++i) {
    mean.add(looks_displaced(delta, place(i), sigmas), joints(i), now_s);
    mean.end_posture(now_s += 10);
  }
  return mean;
}

TEST(PostureMean, OfFewPosturesSaysNothing) {
  EXPECT_FALSE(mean_of(4, some_delta()).shift());
  EXPECT_TRUE(mean_of(5, some_delta()).shift());
}

TEST(PostureMean, WhatPosturesShareIsFoundWhereverTheyAre) {
  const auto shift = mean_of(20, some_delta()).shift();
  ASSERT_TRUE(shift);
  const Vector6d expected = shift_of_point(shift->middle_base) * some_delta();
  EXPECT_TRUE(shift->turn_shift.isApprox(expected, 1e-6));
}

TEST(PostureMean, TheirOwnErrorsAverageOutAndThatOfThePoseDoesNot) {
  const double few = mean_of(5, some_delta()).shift()->covariance(5, 5);
  const double many = mean_of(200, some_delta()).shift()->covariance(5, 5);
  EXPECT_LT(many, 0.5 * kOwn_m * kOwn_m);
  EXPECT_LT(many, few);
  EXPECT_GT(many, kPose_m * kPose_m);
}

TEST(PostureMean, OneThatDisagreesIsLeftOut) { EXPECT_FALSE(mean_of(40, some_delta(), 4.5).shift()); }

TEST(PostureMean, ManyComparisonsOfOnePostureAreOne) {
  PostureMean mean;
  for (int i = 0; i < 500; ++i) mean.add(looks_displaced(some_delta(), place(0)), joints(0), i);
  mean.end_posture(10);
  EXPECT_FALSE(mean.shift());
}

TEST(PostureMean, PosturesThatComeAgainAreNoOthers) {
  PostureMean mean;
  double now_s = 0;
  for (int i = 0; i < 500; ++i) {
    mean.add(looks_displaced(some_delta(), place(i % 4)), joints(i % 4), now_s);
    mean.end_posture(now_s += 10);
  }
  EXPECT_FALSE(mean.shift()) << "four postures, however often";
}

TEST(PostureMean, ForgetsPosturesThatManyHaveFollowed) {
  PostureMean mean = mean_of(30, some_delta());
  double now_s = 300;
  for (int i = 0; i < 60; ++i) {
    mean.add(looks_displaced(Vector6d::Zero(), place(i)), joints(100 + i), now_s);
    mean.end_posture(now_s += 10);
  }
  EXPECT_LT(mean.shift()->turn_shift.norm(), 1e-5);
}

TEST(PostureMean, ForgetsWhatIsMoreThanAnHourAgo) {
  PostureMean mean = mean_of(20, some_delta());
  mean.add(looks_displaced(some_delta(), place(0)), joints(100), 200 + 3500);
  mean.end_posture(200 + 3500);
  ASSERT_TRUE(mean.shift());
  mean.add(looks_displaced(some_delta(), place(1)), joints(101), 200 + 3601);
  EXPECT_FALSE(mean.shift()) << "one posture of now, the others of more than an hour ago";
}

}  // namespace
}  // namespace calibrd
