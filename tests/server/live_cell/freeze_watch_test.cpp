// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/freeze_watch.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

Clock::time_point at(std::chrono::milliseconds ms) { return Clock::time_point(1h) + ms; }

/// Joints and status every 25 ms.
void run(FreezeWatch& watch, std::chrono::milliseconds begin, std::chrono::milliseconds end, bool changes,
         std::optional<bool> in_motion) {
  for (auto t = begin; t < end; t += 25ms) {
    watch.on_joints(at(t), changes);
    watch.on_status(at(t), in_motion);
  }
}

TEST(FreezeWatch, JointsThatRepeatWhileTheRobotIsSaidToMoveAreFrozen) {
  FreezeWatch watch(2s);
  run(watch, 0ms, 1000ms, true, true);
  EXPECT_FALSE(watch.is_frozen());
  run(watch, 1000ms, 1300ms, false, true);
  EXPECT_FALSE(watch.is_frozen());
  run(watch, 1300ms, 1600ms, false, true);
  EXPECT_TRUE(watch.is_frozen());
}

TEST(FreezeWatch, FrozenJointsStayFrozenWhenTheRobotStopsUntilTheyChange) {
  FreezeWatch watch(2s);
  run(watch, 0ms, 1000ms, false, true);
  run(watch, 1000ms, 9000ms, false, false);
  EXPECT_TRUE(watch.is_frozen());
  watch.on_joints(at(9000ms), true);
  EXPECT_FALSE(watch.is_frozen());
}

TEST(FreezeWatch, ARobotThatStandsIsNotFrozen) {
  FreezeWatch watch(2s);
  run(watch, 0ms, 60s, false, false);
  EXPECT_FALSE(watch.is_frozen());
  run(watch, 60s, 120s, false, std::nullopt);
  EXPECT_FALSE(watch.is_frozen());
}

TEST(FreezeWatch, ShortMotionsCountTogetherUntilTheJointsChange) {
  for (const bool changes : {false, true}) {
    FreezeWatch watch(2s);
    for (auto t = 0ms; t < 10s; t += 500ms) {
      run(watch, t, t + 200ms, false, true);
      run(watch, t + 200ms, t + 500ms, changes, false);
      EXPECT_EQ(watch.is_frozen(), !changes && t >= 1000ms) << t.count();
    }
  }
}

TEST(FreezeWatch, KnowsWhenMotionWasSaid) {
  FreezeWatch watch(2s);
  watch.on_status(at(100ms), true);
  watch.on_status(at(125ms), false);
  EXPECT_TRUE(watch.said_in_motion(at(90ms), at(110ms)));
  EXPECT_FALSE(watch.said_in_motion(at(110ms), at(200ms)));
  EXPECT_EQ(*watch.newest_status(), at(125ms));
}

}  // namespace
}  // namespace calibrd
