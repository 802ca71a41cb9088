// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_watch.hpp"

#include "drivers/robot/motion/motion_error.hpp"
#include "tests/drivers/robot/motion/motion_fixture.hpp"

namespace calibrd {
namespace {

class MotionWatchTest : public testing::Test {
 protected:
  MotionWatchTest() {
    RobotLinkHealth health;
    health.state = RobotLinkHealth::State::streaming;
    watch_.take(health);
  }
  /// The robot stands so long at `joint`.
  void stand(std::chrono::milliseconds time, double joint = 0.5) {
    for (const auto end = now_ + time; now_ < end; now_ += 25ms) {
      watch_.take(ControllerJoints{0, {joint}, {}, 1, now_});
      watch_.take(fine_status(now_));
    }
  }
  bool is_fine() const { return !watch_.doubt_before_start(now_).has_value(); }

  Clock::time_point now_{1000s};
  MotionWatch watch_{{}};
};

TEST_F(MotionWatchTest, ThereIsNoDoubtAfterARest) {
  EXPECT_FALSE(is_fine());
  stand(500ms);
  EXPECT_FALSE(is_fine());
  stand(700ms);
  EXPECT_TRUE(is_fine());
}

TEST_F(MotionWatchTest, AStatusOfMotionEndsTheRest) {
  stand(2s);
  auto status = fine_status(now_);
  status.in_motion = true;
  watch_.take(status);
  stand(500ms);
  EXPECT_EQ(watch_.doubt_before_start(now_)->code, MotionError::not_at_rest);
  stand(700ms);
  EXPECT_TRUE(is_fine());
}

TEST_F(MotionWatchTest, SlowCreepIsNoRest) {
  for (int i = 0; i < 200; ++i) stand(25ms, 0.0005 * i);
  EXPECT_EQ(watch_.doubt_before_start(now_)->code, MotionError::not_at_rest);
}

TEST_F(MotionWatchTest, WhatWasNotSeenIsNoRest) {
  stand(2s);
  now_ += 1s;
  stand(500ms);
  EXPECT_EQ(watch_.doubt_before_start(now_)->code, MotionError::not_at_rest);
}

TEST_F(MotionWatchTest, JointsThatGrowOldAreADoubt) {
  stand(2s);
  EXPECT_FALSE(watch_.doubt(now_));
  now_ += 300ms;
  EXPECT_EQ(watch_.doubt(now_)->code, MotionError::joints_stale);
}

}  // namespace
}  // namespace calibrd
