// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A slide that one thing alone shows: it was pushed, or the sensor has slid.
#include "tests/core/drift/pushed_box.hpp"

namespace calibrd {
namespace {

using namespace test;

class AbsorbedBox : public PushedBox {
 protected:
  static DriftSettings quick() {
    DriftSettings settings;
    settings.absorb_s = 5;
    return settings;
  }
  AbsorbedBox() : PushedBox(corner({0.3}), quick()) {}
};

TEST_F(AbsorbedBox, OnceTheRobotHasSaidThatTheSensorStandsIsBackground) {
  watch_for(4);
  room_.blocks.back().middle.x() += kPushed_m;
  watch_for(12);
  EXPECT_FALSE(watch_.is_in_place()) << "nobody has said that it was the box";
  for (int i = 0; i < 8; ++i) {
    check(Vector6d::Zero());
    watch_for(1);
  }
  watch_for(3);
  EXPECT_TRUE(watch_.is_in_place());
}

TEST_F(AbsorbedBox, ThatNoPostureHasDeniedToBeTheSensorIsNone) {
  watch_for(4);
  moved_.tail<3>() = kSlid_m * true_T_base_sensor().linear().col(0);
  for (int second = 0; second < 12; ++second) {
    watch_for(1);
    watch_.add_check(robot_seen(moved_), std::vector<double>{0}, now_s_);
  }
  EXPECT_FALSE(watch_.is_in_place()) << "one posture agrees within its own uncertainty, and may err";
  EXPECT_TRUE(watch_.is_contested());
  EXPECT_EQ(moved_at_frame_, -1);
}

TEST_F(PushedBox, ASlideThatSeveralPosturesAffirmIsAMove) {
  watch_for(4);
  moved_.tail<3>() = kSlid_m * true_T_base_sensor().linear().col(0);
  for (int posture = 0; posture < 4; ++posture) {
    watch_for(1);
    check(moved_);
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::sensor_moved);
}

TEST_F(PushedBox, WhatOnePostureDeniesOthersMayAffirm) {
  watch_for(4);
  moved_.tail<3>() = kSlid_m * true_T_base_sensor().linear().col(0);
  watch_for(2);
  check(Vector6d::Zero());
  watch_for(0.2);
  EXPECT_FALSE(watch_.is_contested());
  for (int posture = 0; posture < 2; ++posture) {
    watch_for(1);
    check(moved_);
  }
  watch_for(0.2);
  EXPECT_TRUE(watch_.is_contested()) << "the first posture alone stands for it";
  for (int posture = 0; posture < 5; ++posture) {
    watch_for(1);
    check(moved_);
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::sensor_moved);
}

TEST_F(PushedBox, APostureThatComesBackHasNoFurtherVoice) {
  watch_for(4);
  moved_.tail<3>() = kSlid_m * true_T_base_sensor().linear().col(0);
  const auto all = postures(2);
  for (int visit = 0; visit < 8; ++visit) {
    watch_for(0.5);
    watch_.add_check(robot_seen(moved_), all[static_cast<std::size_t>(visit % 2)], now_s_);
  }
  EXPECT_NE(watch_for(0.1), DriftVerdict::sensor_moved);
  EXPECT_TRUE(watch_.is_contested());
}

TEST_F(PushedBox, ASensorThatSlidBeforeItIsWatchedIsNotLearntFromThere) {
  moved_.tail<3>() = 0.004 * true_T_base_sensor().linear().col(0);
  watch_for(5);
  EXPECT_TRUE(watch_.is_unsettled());
  EXPECT_FALSE(watch_.is_in_place());
}

TEST_F(PushedBox, ASlideThatOneThingAloneShowsIsNoEvidenceThatTheSensorStands) {
  watch_for(4);
  EXPECT_TRUE(watch_.is_in_place());
  moved_.tail<3>() = 0.004 * true_T_base_sensor().linear().col(0);
  EXPECT_EQ(watch_for(3.5), DriftVerdict::no_evidence);
  EXPECT_FALSE(watch_.is_in_place());
  EXPECT_TRUE(watch_.wants_check());
  EXPECT_TRUE(watch_.is_out_of_sight());
  check(Vector6d::Zero());
  watch_for(0.2);
  EXPECT_FALSE(watch_.is_out_of_sight()) << "the robot says that it is the box";
  watch_for(5);
  EXPECT_FALSE(watch_.is_out_of_sight()) << "it has said so, and nothing has changed since";
  EXPECT_FALSE(watch_.is_contested());
  moved_.tail<3>() = 0.008 * true_T_base_sensor().linear().col(0);
  watch_for(3);
  EXPECT_TRUE(watch_.is_out_of_sight());
}

TEST_F(PushedBox, ASlideThatTheRobotShowsTooIsNeverInPlace) {
  watch_for(4);
  moved_.tail<3>() = kPushed_m * true_T_base_sensor().linear().col(0);
  for (int posture = 0; posture < 4; ++posture) {
    watch_for(1);
    check(moved_);
  }
  EXPECT_FALSE(watch_.is_in_place());
  EXPECT_NE(verdict(), DriftVerdict::in_place);
}

}  // namespace
}  // namespace calibrd
