// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/timing/time_offset_estimator.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;
using namespace std::chrono_literals;

constexpr double kCycle_s = 0.025, kFrame_s = 1.0 / 6;

std::vector<double> joints_truly_at(double t) {
  auto joints = postures(1).front();
  joints[0] += 0.35 * std::sin(1.3 * t);
  joints[1] += 0.2 * std::sin(0.9 * t + 1);
  joints[2] += 0.25 * std::sin(1.7 * t + 2);
  return joints;
}

Clock::time_point at(double t) {
  return Clock::time_point(1h) +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(t));
}
double seconds_of(Clock::time_point time) {
  return std::chrono::duration<double>(time - Clock::time_point(1h)).count();
}

/// Reported every cycle, linear in between.
std::optional<std::vector<double>> reported_at(Clock::time_point time) {
  const double t = seconds_of(time), begin = std::floor(t / kCycle_s) * kCycle_s;
  auto joints = joints_truly_at(begin);
  const auto after = joints_truly_at(begin + kCycle_s);
  for (std::size_t j = 0; j < joints.size(); ++j)
    joints[j] += (t - begin) / kCycle_s * (after[j] - joints[j]);
  return joints;
}

/// Frames stamped `late_s` after they were exposed.
std::optional<TimeOffset> estimate_of(double late_s, const Pose& T_base_sensor, int frames = 60,
                                      const SceneSettings& scene_settings = {}) {
  SceneSettings scene = scene_settings;
  TimeOffsetEstimator estimator(VirtualCell(test_arm()), scene.camera);
  const DepthCorrection correction;
  for (int i = 0; i < frames; ++i) {
    const double t = kFrame_s * i;
    scene.seed = static_cast<std::uint64_t>(i + 1);
    const View view = render_view(joints_truly_at(t), true_T_base_sensor(), scene);
    estimator.add({view.depth, at(t + late_s), T_base_sensor, correction}, reported_at);
  }
  return estimator.estimate();
}

TEST(TimeOffset, IsFoundToThreeMilliseconds) {
  for (const double late_s : {-0.03, 0.0, 0.03, 0.08}) {
    const auto found = estimate_of(late_s, true_T_base_sensor());
    ASSERT_TRUE(found) << late_s;
    EXPECT_NEAR(found->value_s, late_s, 0.003);
    EXPECT_LT(found->sigma_s, 0.004);
    EXPECT_LT(std::abs(found->value_s - late_s), 4 * found->sigma_s);
  }
}

TEST(TimeOffset, IsFoundWithAPoseThatIsOffAndClutterAround) {
  SceneSettings scene;
  scene.clutter = true;
  const auto found = estimate_of(0.05, off_by(true_T_base_sensor(), 0.001, 0.001, 3), 70, scene);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value_s, 0.05, 0.004);
}

TEST(TimeOffset, SomebodyInFrontDoesNotBendIt) {
  SceneSettings scene;
  scene.hidden_share = 0.45;
  const auto found = estimate_of(0.05, true_T_base_sensor(), 70, scene);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value_s, 0.05, 0.004);
}

TEST(TimeOffset, NothingIsSaidWithoutJointsOrRobotOrAPoseThatFits) {
  EXPECT_FALSE(estimate_of(0.03, off_by(true_T_base_sensor(), 0.5, 0.5, 1), 40));
  TimeOffsetEstimator estimator(VirtualCell(test_arm()), ideal_kinect2());
  const View view = render_view(joints_truly_at(0), true_T_base_sensor(), {});
  const DepthCorrection correction;
  EXPECT_FALSE(estimator.add({view.depth, at(0), true_T_base_sensor(), correction},
                             [](Clock::time_point) { return std::nullopt; }));
}

TEST(TimeOffset, AnotherLatencyIsTakenUpAfterAWhile) {
  SceneSettings scene;
  TimeOffsetEstimator estimator(VirtualCell(test_arm()), scene.camera);
  const DepthCorrection correction;
  for (int i = 0; i < 150; ++i) {
    const double t = kFrame_s * i, late_s = i < 50 ? 0.0 : 0.08;
    scene.seed = static_cast<std::uint64_t>(i + 1);
    const View view = render_view(joints_truly_at(t), true_T_base_sensor(), scene);
    estimator.add({view.depth, at(t + late_s), true_T_base_sensor(), correction}, reported_at);
  }
  ASSERT_TRUE(estimator.estimate());
  EXPECT_NEAR(estimator.estimate()->value_s, 0.08, 0.004);
}

}  // namespace
}  // namespace calibrd
