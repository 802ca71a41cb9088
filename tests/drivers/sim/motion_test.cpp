// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace calibrd::sim {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kBegin_ns = 5 * kSecond;

Joints joints(double first, double second) { return {first, second}; }

double largest(const Joints& q) {
  double most = 0;
  for (double value : q) most = std::max(most, std::abs(value));
  return most;
}

/// Highest speed and highest jump of speed within a millisecond, over a stretch of time.
struct Course {
  double top_speed = 0, top_acceleration = 0;
};

Course course(const MotionPlan& plan, std::int64_t from, std::int64_t to) {
  Course found;
  Joints before = plan.velocities_at(from);
  for (std::int64_t t = from; t < to; t += kSecond / 1000) {
    const Joints now = plan.velocities_at(t);
    found.top_speed = std::max(found.top_speed, largest(now));
    for (std::size_t j = 0; j < kMaxJoints; ++j)
      found.top_acceleration = std::max(found.top_acceleration, std::abs(now[j] - before[j]) * 1000);
    before = now;
  }
  return found;
}

MotionPlan visiting(Profile profile, double speed, double hold_s) {
  MotionPlan plan;
  plan.place(joints(0.1, 0.2), kBegin_ns);
  plan.visit(std::array{joints(1.1, 0.2), joints(0.4, -0.5)}, profile, speed, hold_s, kBegin_ns);
  return plan;
}

TEST(Motion, RestsWhereItIsPlaced) {
  MotionPlan plan;
  plan.place(joints(0.3, -0.7), kBegin_ns);
  EXPECT_EQ(plan.positions_at(kBegin_ns + 100 * kSecond), joints(0.3, -0.7));
  EXPECT_EQ(plan.positions_at(kBegin_ns - kSecond), joints(0.3, -0.7));
}

TEST(Motion, VisitsEachPostureAndHoldsThere) {
  const MotionPlan plan = visiting(Profile::minimum_jerk, 0.5, 2.0);
  // 0.3 s to come to rest, then 1 rad at a peak of 0.5 rad/s: 1.875 / 0.5 = 3.75 s.
  const std::int64_t arrived = kBegin_ns + kSecond * 3 / 10 + kSecond * 375 / 100;
  EXPECT_NEAR(plan.positions_at(arrived)[0], 1.1, 1e-9);
  EXPECT_EQ(plan.positions_at(arrived + kSecond), joints(1.1, 0.2));
  EXPECT_LT(plan.positions_at(arrived + 3 * kSecond)[0], 1.0);
}

TEST(Motion, ReachesTheStatedSpeedAndNoMore) {
  for (const Profile profile : {Profile::minimum_jerk, Profile::constant_speed}) {
    const Course found = course(visiting(profile, 0.5, 0.5), kBegin_ns, kBegin_ns + 30 * kSecond);
    EXPECT_NEAR(found.top_speed, 0.5, 0.005);
  }
}

TEST(Motion, NeverJumpsInSpeed) {
  EXPECT_LT(
      course(visiting(Profile::minimum_jerk, 0.5, 0.5), kBegin_ns, kBegin_ns + 30 * kSecond).top_acceleration,
      1.0);
  EXPECT_LT(course(visiting(Profile::constant_speed, 0.5, 0.0), kBegin_ns, kBegin_ns + 30 * kSecond)
                .top_acceleration,
            3.0);
}

TEST(Motion, ConstantSpeedIsConstantMostOfTheWay) {
  const MotionPlan plan = visiting(Profile::constant_speed, 0.25, 0);
  for (double s = 1.0; s < 3.5; s += 0.1)
    EXPECT_NEAR(plan.velocities_at(kBegin_ns + static_cast<std::int64_t>(s * kSecond))[0], 0.25, 1e-6) << s;
}

TEST(Motion, LoopsForEver) {
  const MotionPlan plan = visiting(Profile::minimum_jerk, 0.5, 1.0);
  // From the first loop on: 0.7 rad there, 0.7 rad back, two holds.
  const auto cycle = static_cast<std::int64_t>((2 * 0.7 * 1.875 / 0.5 + 2.0) * kSecond);
  const std::int64_t t = kBegin_ns + 20 * kSecond;
  for (std::size_t j = 0; j < 2; ++j)
    EXPECT_NEAR(plan.positions_at(t)[j], plan.positions_at(t + 1000 * cycle)[j], 1e-6);
}

TEST(Motion, HoldStopsSmoothlyAndResumeGoesOn) {
  MotionPlan plan = visiting(Profile::minimum_jerk, 0.5, 1.0);
  const std::int64_t moving = kBegin_ns + 2 * kSecond;
  const Joints without = plan.positions_at(moving);
  plan.set_rate(0, moving);
  EXPECT_EQ(plan.positions_at(moving), without);
  EXPECT_LT(course(plan, moving - kSecond, moving + kSecond).top_acceleration, 3.0);
  const Joints held = plan.positions_at(moving + kSecond);
  EXPECT_EQ(held, plan.positions_at(moving + 50 * kSecond));
  plan.set_rate(1, moving + 50 * kSecond);
  EXPECT_LT(course(plan, moving + 49 * kSecond, moving + 52 * kSecond).top_acceleration, 3.0);
  EXPECT_GT(plan.positions_at(moving + 51 * kSecond)[0], held[0] + 0.05);
}

TEST(Motion, NewProgramStartsFromWhereTheRobotIs) {
  MotionPlan plan = visiting(Profile::minimum_jerk, 0.5, 1.0);
  const std::int64_t moving = kBegin_ns + 2 * kSecond;
  plan.visit(std::vector{joints(-1, -1)}, Profile::minimum_jerk, 0.4, 1.0, moving);
  plan.visit(std::vector{joints(-1, 1)}, Profile::minimum_jerk, 0.4, 1.0, moving + kSecond / 10);
  const Course found = course(plan, moving - kSecond, moving + 20 * kSecond);
  EXPECT_LT(found.top_speed, 0.5 + 1e-6);
  EXPECT_LT(found.top_acceleration, 3.0);
  EXPECT_EQ(plan.positions_at(moving + 60 * kSecond), joints(-1, 1));
}

}  // namespace
}  // namespace calibrd::sim
