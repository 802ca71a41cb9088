// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/view_gate.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

Clock::time_point at(std::chrono::milliseconds ms) { return Clock::time_point(1h) + ms; }

/// Joints every 25 ms up to `until`; they turn at `speed_rad_s` from `starts_moving` on.
JointHistory joints(std::chrono::milliseconds until, double speed_rad_s = 0,
                    std::chrono::milliseconds starts_moving = 0ms) {
  JointHistory history;
  for (auto t = 0ms; t <= until; t += 25ms) {
    const double moved =
        t > starts_moving ? speed_rad_s * std::chrono::duration<double>(t - starts_moving).count() : 0;
    history.add({{0.5, moved}, {}, static_cast<std::uint64_t>(t.count()), at(t)});
  }
  return history;
}

FrameDecision judge(const JointHistory& history, std::chrono::milliseconds frame,
                    std::chrono::milliseconds now, ViewGateSettings settings = {}) {
  ViewGate gate(settings);
  EXPECT_EQ(gate.enter(1, at(frame)), FrameVerdict::usable);
  return gate.judge(history, at(now));
}

TEST(ViewGate, FrameOfARobotThatStoodStillIsAView) {
  const auto decision = judge(joints(1000ms), 990ms, 1000ms);
  EXPECT_EQ(decision.verdict, FrameVerdict::usable);
  ASSERT_TRUE(decision.positions_rad);
  EXPECT_DOUBLE_EQ((*decision.positions_rad)[0], 0.5);
}

TEST(ViewGate, WaitsForTheJointsAfterTheFrame) {
  EXPECT_EQ(judge(joints(975ms), 990ms, 991ms).verdict, FrameVerdict::awaiting_joints);
  EXPECT_EQ(judge(joints(1000ms), 990ms, 1001ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, MovingRobotGivesNoViewButItsPositionsAreKnown) {
  const auto decision = judge(joints(1000ms, 0.5), 990ms, 1000ms);
  EXPECT_EQ(decision.verdict, FrameVerdict::moving);
  ASSERT_TRUE(decision.positions_rad);
  EXPECT_NEAR((*decision.positions_rad)[1], 0.495, 1e-12);
}

TEST(ViewGate, RobotMustHaveSettled) {
  JointHistory history;  // moves until 800 ms, still from then on
  for (auto t = 0ms; t <= 1500ms; t += 25ms)
    history.add({{0.5 * std::chrono::duration<double>(std::min(t, 800ms)).count()}, {}, 0, at(t)});
  EXPECT_EQ(judge(history, 1000ms, 1500ms).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge(history, 1110ms, 1500ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, MotionThatBeginsRightAfterTheExposureSpoilsTheFrame) {
  EXPECT_EQ(judge(joints(1000ms, 0.5, 975ms), 980ms, 1000ms).verdict, FrameVerdict::moving);
}

TEST(ViewGate, LatencyIsTakenOffTheStamp) {
  ViewGateSettings settings;
  settings.latency = 40ms;
  EXPECT_EQ(judge(joints(1000ms, 0.5, 975ms), 1010ms, 1010ms, settings).verdict, FrameVerdict::usable);
  EXPECT_EQ(judge(joints(1000ms, 0.5, 975ms), 1030ms, 1030ms, settings).verdict, FrameVerdict::moving);
}

TEST(ViewGate, SlowCreepIsMotion) {
  EXPECT_EQ(judge(joints(1000ms, 0.003), 990ms, 1000ms).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge(joints(1000ms, 0.001), 990ms, 1000ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, StaleJointsGiveNoView) {
  EXPECT_EQ(judge(joints(1000ms), 1300ms, 1300ms).verdict, FrameVerdict::joints_stale);
  EXPECT_EQ(judge(JointHistory(), 100ms, 100ms).verdict, FrameVerdict::no_joints);
}

TEST(ViewGate, GapInTheJointsAroundTheFrameGivesNoView) {
  JointHistory history = joints(700ms);
  history.add({{0.5, 0}, {}, 99, at(1000ms)});
  EXPECT_EQ(judge(history, 900ms, 1000ms).verdict, FrameVerdict::joints_stale);
}

TEST(ViewGate, GapWithinTheSettleTimeGivesNoView) {
  JointHistory history = joints(600ms);
  for (auto t = 900ms; t <= 1000ms; t += 25ms) history.add({{0.5, 0}, {}, 99, at(t)});
  EXPECT_EQ(judge(history, 990ms, 1000ms).verdict, FrameVerdict::moving);
}

TEST(ViewGate, FrameOlderThanAllJointsGivesNoView) {
  EXPECT_EQ(judge(joints(100ms), -10ms, 100ms).verdict, FrameVerdict::no_joints);
}

TEST(ViewGate, RepeatedAndOlderFramesAreRefused) {
  ViewGate gate({});
  EXPECT_EQ(gate.enter(5, at(100ms)), FrameVerdict::usable);
  EXPECT_EQ(gate.enter(5, at(133ms)), FrameVerdict::repeated);
  EXPECT_EQ(gate.enter(4, at(133ms)), FrameVerdict::out_of_order);
  EXPECT_EQ(gate.enter(6, at(99ms)), FrameVerdict::out_of_order);
  EXPECT_EQ(gate.enter(7, at(133ms)), FrameVerdict::usable);
}

TEST(ViewGate, StillRobotIsRecognised) {
  EXPECT_TRUE(is_still(joints(1000ms), {}, at(1000ms)));
  EXPECT_FALSE(is_still(joints(1000ms, 0.5), {}, at(1000ms)));
  EXPECT_FALSE(is_still(joints(1000ms), {}, at(1300ms)));
  EXPECT_FALSE(is_still(JointHistory(), {}, at(0ms)));
}

}  // namespace
}  // namespace calibrd
