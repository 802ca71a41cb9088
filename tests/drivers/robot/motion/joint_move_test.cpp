// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/joint_move.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace calibrd {
namespace {

struct Peaks {
  double speed = 0, acceleration = 0;
  void take(double v, double a) {
    speed = std::max(speed, std::abs(v));
    acceleration = std::max(acceleration, std::abs(a));
  }
};

/// Of the profile itself, every millisecond.
Peaks peaks_of(const JointMove& move) {
  Peaks peaks;
  for (double t = 0; t <= move.duration_s(); t += 0.001) {
    const auto point = move.at(t);
    for (std::size_t j = 0; j < point.positions_rad.size(); ++j)
      peaks.take(point.velocities_rad_s[j], point.accelerations_rad_s2[j]);
  }
  return peaks;
}

/// Of what MotoROS makes of the points: acceleration linear in time from positions and speeds of both ends.
Peaks peaks_of_controller(const JointMove& move) {
  Peaks peaks;
  for (int i = 0; i + 1 < move.point_count(); ++i) {
    const auto a = move.point(i), b = move.point(i + 1);
    const double h = b.time_s - a.time_s;
    for (std::size_t j = 0; j < a.positions_rad.size(); ++j) {
      const double way = b.positions_rad[j] - a.positions_rad[j];
      const double va = a.velocities_rad_s[j], vb = b.velocities_rad_s[j];
      const double c1 = 6 * way / (h * h) - 2 * (vb + 2 * va) / h;
      const double c2 = -12 * way / (h * h * h) + 6 * (va + vb) / (h * h);
      for (double t = 0; t <= h; t += 0.002) peaks.take(va + c1 * t + c2 * t * t / 2, c1 + c2 * t);
    }
  }
  return peaks;
}

TEST(JointMove, NeverExceedsSpeedNorAccelerationAlsoAsTheControllerInterpolates) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> joint(-3, 3), speed(0.01, 0.6), acceleration(0.02, 2);
  for (int round = 0; round < 60; ++round) {
    std::vector<double> from(7), to(7);
    for (double& q : from) q = joint(random);
    const double share = std::pow(10, -round % 4);  // short ways too
    for (std::size_t j = 0; j < 7; ++j) to[j] = from[j] + share * (joint(random) - from[j]);
    const JointMoveLimits limits{speed(random), acceleration(random)};
    const JointMove move(from, to, limits);
    for (const Peaks& peaks : {peaks_of(move), peaks_of_controller(move)}) {
      EXPECT_LE(peaks.speed, limits.max_speed_rad_s);
      EXPECT_LE(peaks.acceleration, limits.max_acceleration_rad_s2);
    }
  }
}

TEST(JointMove, ALongWayIsMadeNearlyAtTheSpeedAllowed) {
  const JointMove move({0, 0}, {1.5, -0.2}, {0.1, 10});
  EXPECT_GT(peaks_of(move).speed, 0.095);
}

TEST(JointMove, IsStraightInJointSpaceAndAllJointsArriveTogether) {
  const JointMove move({0.1, -0.2, 0.5}, {0.5, 0.6, 0.5}, {0.2, 0.5});
  for (double t = 0; t <= move.duration_s(); t += 0.05) {
    const auto q = move.at(t).positions_rad;
    EXPECT_NEAR((q[0] - 0.1) / 0.4, (q[1] + 0.2) / 0.8, 1e-12);
    EXPECT_DOUBLE_EQ(q[2], 0.5);
  }
}

TEST(JointMove, BeginsAndEndsAtRestAndStaysThere) {
  const JointMove move({0.1}, {0.5}, {0.2, 0.5});
  EXPECT_EQ(move.point(0).positions_rad[0], 0.1);
  const auto end = move.point(move.point_count() - 1);
  EXPECT_EQ(end.positions_rad[0], 0.5);
  EXPECT_NEAR(end.time_s, move.duration_s(), 1e-12);
  for (const auto& point : {move.at(-1), move.point(0), end, move.at(1000)}) {
    EXPECT_NEAR(point.velocities_rad_s[0], 0, 1e-12);
    EXPECT_NEAR(point.accelerations_rad_s2[0], 0, 1e-12);
  }
  EXPECT_EQ(move.at(1000).positions_rad[0], 0.5);
}

TEST(JointMove, AWayOfNothingIsAMoveThatStandsStill) {
  const JointMove move({0.1, 0.2}, {0.1, 0.2}, {0.2, 0.5});
  EXPECT_GT(move.point_count(), 2);
  EXPECT_EQ(peaks_of(move).speed, 0);
}

}  // namespace
}  // namespace calibrd
