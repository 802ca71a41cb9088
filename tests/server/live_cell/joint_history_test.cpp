// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/joint_history.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

Clock::time_point at(std::chrono::milliseconds ms) { return Clock::time_point(1h) + ms; }
JointState state(std::chrono::milliseconds t, double position) { return {{position}, {}, 0, at(t)}; }

TEST(JointHistory, InterpolatesBetweenItsStates) {
  JointHistory history;
  history.add(state(0ms, 1));
  history.add(state(100ms, 2));
  EXPECT_DOUBLE_EQ(history.positions_at(at(25ms))->front(), 1.25);
  EXPECT_DOUBLE_EQ(history.positions_at(at(0ms))->front(), 1);
  EXPECT_DOUBLE_EQ(history.positions_at(at(100ms))->front(), 2);
}

TEST(JointHistory, NeverExtrapolates) {
  JointHistory history;
  history.add(state(0ms, 1));
  history.add(state(100ms, 2));
  EXPECT_FALSE(history.positions_at(at(-1ms)));
  EXPECT_FALSE(history.positions_at(at(101ms)));
}

TEST(JointHistory, ForgetsWhatIsOlderThanItsSpan) {
  JointHistory history(1s);
  for (auto t = 0ms; t <= 3000ms; t += 25ms) history.add(state(t, 0));
  EXPECT_EQ(history.states().size(), 41U);
  EXPECT_FALSE(history.positions_at(at(1900ms)));
}

TEST(JointHistory, IgnoresStatesThatAreNotNewer) {
  JointHistory history;
  history.add(state(100ms, 1));
  history.add(state(100ms, 2));
  history.add(state(50ms, 3));
  EXPECT_EQ(history.states().size(), 1U);
  EXPECT_DOUBLE_EQ(history.newest()->positions_rad[0], 1);
}

TEST(JointHistory, MotionIsTheLargestExcursionBetweenTwoTimes) {
  JointHistory history;
  history.add(state(0ms, 0));
  history.add(state(25ms, 0.5));
  history.add(state(50ms, 0.1));
  history.add(state(75ms, 0.1));
  EXPECT_DOUBLE_EQ(*history.motion(at(10ms), at(60ms), 50ms), 0.5);
  EXPECT_DOUBLE_EQ(*history.motion(at(50ms), at(60ms), 50ms), 0);
  EXPECT_FALSE(history.motion(at(10ms), at(80ms), 50ms));
  EXPECT_FALSE(history.motion(at(10ms), at(60ms), 20ms));
}

}  // namespace
}  // namespace calibrd
