// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/view_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/registration/scene.hpp"

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
  const auto decision = judge(joints(1000ms), 890ms, 1000ms);
  EXPECT_EQ(decision.verdict, FrameVerdict::usable);
  ASSERT_TRUE(decision.positions_rad);
  EXPECT_DOUBLE_EQ((*decision.positions_rad)[0], 0.5);
}

TEST(ViewGate, WaitsForTheJointsAfterTheFrame) {
  EXPECT_EQ(judge(joints(975ms), 990ms, 991ms).verdict, FrameVerdict::awaiting_joints);
  EXPECT_EQ(judge(joints(1000ms), 990ms, 1001ms).verdict, FrameVerdict::awaiting_joints);
  EXPECT_EQ(judge(joints(1100ms), 990ms, 1101ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, MotionThatLateJointsTellOfOnlyAfterTheExposureSpoilsTheFrame) {
  EXPECT_EQ(judge(joints(1100ms, 0.5, 975ms), 900ms, 1100ms).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge(joints(1100ms, 0.5, 1025ms), 900ms, 1100ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, AnEstimatedOffsetNeedsNotWaitForLateJoints) {
  ViewGate gate({});
  gate.set_offset(AppliedOffset{0ms, 0.002});
  EXPECT_EQ(gate.enter(1, at(900ms)), FrameVerdict::usable);
  EXPECT_EQ(gate.judge(joints(925ms), at(926ms)).verdict, FrameVerdict::usable);
  EXPECT_EQ(gate.judge(joints(1100ms, 0.5, 975ms), at(1100ms)).verdict, FrameVerdict::usable);
}

TEST(ViewGate, JointsThatStopRightAfterTheFrameAreStale) {
  EXPECT_EQ(judge(joints(1000ms), 990ms, 1300ms).verdict, FrameVerdict::joints_stale);
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
  settings.lateness = 0ms;
  EXPECT_EQ(judge(joints(1000ms, 0.5, 975ms), 1010ms, 1010ms, settings).verdict, FrameVerdict::usable);
  EXPECT_EQ(judge(joints(1000ms, 0.5, 975ms), 1030ms, 1030ms, settings).verdict, FrameVerdict::moving);
}

TEST(ViewGate, SlowCreepIsMotion) {
  EXPECT_EQ(judge(joints(1000ms, 0.003), 990ms, 1000ms).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge(joints(1000ms, 0.001), 890ms, 1000ms).verdict, FrameVerdict::usable);
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

DepthImage picture(std::uint16_t value) { return {4, 3, 0.001, std::vector<std::uint16_t>(12, value)}; }

TEST(ViewGate, AFrameWhosePixelsRepeatUnderANewStampIsRefused) {
  ViewGate gate({});
  const DepthImage one = picture(1500), other = picture(1501), dark = picture(0);
  EXPECT_EQ(gate.enter(1, at(0ms), &one), FrameVerdict::usable);
  EXPECT_EQ(gate.enter(2, at(33ms), &one), FrameVerdict::repeated);
  EXPECT_EQ(gate.enter(3, at(66ms), &one), FrameVerdict::repeated);
  EXPECT_EQ(gate.enter(4, at(100ms), &other), FrameVerdict::usable);
  EXPECT_EQ(gate.enter(5, at(133ms), &dark), FrameVerdict::usable);
  EXPECT_EQ(gate.enter(6, at(166ms), &dark), FrameVerdict::usable);  // covered: it says nothing either way
}

TEST(ViewGate, AFrameWhoseStampRepeatsIsRefused) {
  ViewGate gate({});
  EXPECT_EQ(gate.enter(1, at(33ms)), FrameVerdict::usable);
  EXPECT_EQ(gate.enter(2, at(33ms)), FrameVerdict::repeated);
}

/// Joints as joints() has them, and a status with each.
JointHistory with_status(JointHistory history, bool in_motion) {
  const auto states = history.states();
  for (const auto& state : states) history.note_status(state.stamp, in_motion);
  return history;
}

TEST(ViewGate, ARobotWhoseControllerSaysThatItMovesIsNotStill) {
  const auto decision = judge(with_status(joints(300ms), true), 290ms, 300ms);
  EXPECT_EQ(decision.verdict, FrameVerdict::moving);
  EXPECT_FALSE(decision.positions_rad);  // joints that repeat all the while are in doubt
  EXPECT_EQ(judge(with_status(joints(1000ms), false), 890ms, 1000ms).verdict, FrameVerdict::usable);
}

TEST(ViewGate, FrozenJointsGiveNoViewAlsoWhenTheRobotHasStopped) {
  JointHistory history(10s);
  for (auto t = 0ms; t <= 4000ms; t += 25ms) {
    const double turn = 0.3 * std::chrono::duration<double>(std::min(t, 500ms)).count();
    history.add({{turn, 0}, {}, 0, at(t)});
    history.note_status(at(t), t < 2000ms);  // in truth it turns until 2000 ms
  }
  const auto decision = judge(history, 3990ms, 4000ms);
  EXPECT_EQ(decision.verdict, FrameVerdict::joints_frozen);
  EXPECT_FALSE(decision.positions_rad);
  EXPECT_GT(std::string(reason_of(decision.verdict)).size(), 20U);
}

TEST(ViewGate, StatusThatGoesOnWithoutJointsIsNamed) {
  JointHistory history = joints(1000ms);
  for (auto t = 1000ms; t <= 2000ms; t += 25ms) history.note_status(at(t), false);
  EXPECT_EQ(judge(history, 1990ms, 2000ms).verdict, FrameVerdict::joints_frozen);
}

/// The test arm turning at `speed_rad_s` about its first joint, faster and faster by `acceleration`; one of
/// its messages, of 900 ms, comes late by `delay`.
JointHistory turning(double speed_rad_s, double acceleration = 0, std::chrono::milliseconds delay = 0ms) {
  JointHistory history;
  for (auto t = 0ms; t <= 1000ms; t += 25ms) {
    const double s = std::chrono::duration<double>(t).count();
    auto positions = test::postures(1).front();
    positions[0] += speed_rad_s * s + 0.5 * acceleration * s * s;
    history.add({positions, {}, 0, at(t == 900ms ? t + delay : t)});
  }
  return history;
}

FrameDecision judge_timed(const JointHistory& history, double sigma_s, bool timed_views = true) {
  ViewGateSettings settings;
  settings.timed_views = timed_views;
  ViewGate gate(settings, std::make_shared<const LinkReach>(test::test_arm()));
  gate.set_offset(AppliedOffset{20ms, sigma_s});
  EXPECT_EQ(gate.enter(1, at(910ms)), FrameVerdict::usable);
  return gate.judge(history, at(1000ms));
}

TEST(ViewGate, AMovingRobotsFrameIsAViewWhereItsTimeIsKnownWellEnough) {
  const auto decision = judge_timed(turning(0.2), 0.0005);
  EXPECT_EQ(decision.verdict, FrameVerdict::timed);
  ASSERT_TRUE(decision.positions_rad && decision.timing_error_m);
  EXPECT_NEAR((*decision.positions_rad)[0], test::postures(1).front()[0] + 0.2 * 0.89, 1e-9);
  EXPECT_GT(*decision.timing_error_m, 0.2 * 0.3 * 0.0005);  // points 0.3 m from the axis go with it
  EXPECT_LT(*decision.timing_error_m, 0.2 * 1.5 * 0.0005);
  EXPECT_EQ(judge_timed(turning(0.2), 0.0005, false).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge_timed(turning(0.2), 0.005).verdict, FrameVerdict::moving);
  EXPECT_EQ(judge_timed(turning(2.0), 0.0005).verdict, FrameVerdict::moving);
}

TEST(ViewGate, AMovingRobotsFrameIsNoViewWhereAMessageCameLate) {
  EXPECT_EQ(judge_timed(turning(0.2, 0, 8ms), 0.0005).verdict, FrameVerdict::moving);
  EXPECT_GT(*judge_timed(turning(0.2, 0, 8ms), 0.0005).timing_error_m, 0.2 * 0.3 * 0.008);
}

TEST(ViewGate, AMovingRobotsFrameIsNoViewWhereItCameLateItself) {
  for (const auto late : {0ms, 8ms, 120ms}) {
    ViewGateSettings settings;
    settings.timed_views = true;
    ViewGate gate(settings, std::make_shared<const LinkReach>(test::test_arm()));
    gate.set_offset(AppliedOffset{20ms, 0.0005});
    for (int frame = 0; frame < 10; ++frame)
      if (frame != 6)
        gate.enter(static_cast<std::uint64_t>(frame), at(33ms * frame + (frame == 9 ? late : 0ms)));
    const auto decision = gate.judge(turning(0.2), at(500ms));
    EXPECT_EQ(decision.verdict, late == 0ms ? FrameVerdict::timed : FrameVerdict::moving) << late.count();
    EXPECT_EQ(decision.positions_rad.has_value(), late < 120ms);
  }
}

TEST(ViewGate, AMessageThatCameLateSomeBeforeCountsToo) {
  JointHistory history;
  for (auto t = 0ms; t <= 1000ms; t += 25ms) {
    auto positions = test::postures(1).front();
    positions[0] += 0.2 * std::chrono::duration<double>(t).count();
    history.add(
        {positions, {}, 0, at(t == 825ms ? t + 8ms : t)});  // none of those that tell the acceleration
  }
  EXPECT_EQ(judge_timed(history, 0.0005).verdict, FrameVerdict::moving);
}

TEST(ViewGate, JointsOfAMovingRobotThatCameMuchTooLateAreNotKnown) {
  const auto late = judge_timed(turning(1.0, 0, 60ms), 0.0005), in_time = judge_timed(turning(1.0), 0.0005);
  EXPECT_EQ(late.verdict, FrameVerdict::moving);
  EXPECT_FALSE(late.positions_rad);
  EXPECT_TRUE(in_time.positions_rad);
}

TEST(ViewGate, FastAccelerationBetweenTwoMessagesIsCounted) {
  const auto steady = judge_timed(turning(0.2), 1e-6), jerky = judge_timed(turning(0.2, 20), 1e-6);
  ASSERT_TRUE(steady.timing_error_m && jerky.timing_error_m);
  EXPECT_LT(*steady.timing_error_m, 0.05e-3);
  EXPECT_GT(*jerky.timing_error_m, 0.5e-3);
}

TEST(ViewGate, OldJointsThatComeInABurstAreNoView) {
  JointHistory history = turning(0.2);
  auto positions = history.newest()->positions_rad;
  for (int i = 1; i <= 20; ++i) {  // of the half second before, a millisecond apart
    positions[0] += 0.005;
    history.add({positions, {}, 0, at(1000ms + std::chrono::milliseconds(i))});
  }
  ViewGateSettings settings;
  settings.timed_views = true;
  ViewGate gate(settings, std::make_shared<const LinkReach>(test::test_arm()));
  gate.set_offset(AppliedOffset{0ms, 0.0003});
  EXPECT_EQ(gate.enter(1, at(1010ms) + 500us), FrameVerdict::usable);
  EXPECT_EQ(gate.judge(history, at(1020ms)).verdict, FrameVerdict::moving);
}

TEST(ViewGate, StillRobotIsRecognised) {
  EXPECT_TRUE(is_still(joints(1000ms), {}, at(1000ms)));
  EXPECT_FALSE(is_still(joints(1000ms, 0.5), {}, at(1000ms)));
  EXPECT_FALSE(is_still(joints(1000ms), {}, at(1300ms)));
  EXPECT_FALSE(is_still(JointHistory(), {}, at(0ms)));
}

}  // namespace
}  // namespace calibrd
