// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/pose_watch.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using api::PoseState;

Clock::time_point at(std::chrono::milliseconds ms) { return Clock::time_point(1h) + ms; }
const PoseCheck kAgrees{true, true, 0.95, 0.001, 4000};
const PoseCheck kDisagrees{true, false, 0.2, 0.05, 4000};
const PoseCheck kNothingSeen{false, false, 0, 0, 10};

class Watch : public ::testing::Test {
 protected:
  /// Disagreements from 1 s to 4 s.
  void drift() {
    for (int i = 0; i <= 30; ++i) watch_.on_check(kDisagrees, at(1s + i * 100ms));
  }

  PoseWatch watch_{PoseWatchSettings{}};
};

TEST_F(Watch, WithoutCalibrationThereIsNothingToCheck) {
  EXPECT_EQ(watch_.state(), PoseState::uncalibrated);
  EXPECT_FALSE(watch_.is_check_due(at(0ms)));
  EXPECT_FALSE(watch_.is_valid(at(0ms)));
  watch_.on_check(kAgrees, at(0ms));
  EXPECT_EQ(watch_.state(), PoseState::uncalibrated);
}

TEST_F(Watch, FreshPoseIsValidUntilItHasNotBeenCheckedForTooLong) {
  watch_.set_fresh(at(0ms));
  EXPECT_TRUE(watch_.is_valid(at(59'999ms)));
  EXPECT_FALSE(watch_.is_valid(at(60s)));
  EXPECT_EQ(watch_.state(), PoseState::calibrated);
  EXPECT_NE(watch_.reason(at(60s)).find("max_unverified"), std::string::npos);
}

TEST_F(Watch, StoredPoseIsUnverifiedUntilACheckAgrees) {
  watch_.set_stored();
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_FALSE(watch_.is_valid(at(0ms)));
  watch_.on_check(kNothingSeen, at(1s));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  watch_.on_check(kAgrees, at(2s));
  EXPECT_TRUE(watch_.is_valid(at(2s)));
}

TEST_F(Watch, ChecksWithoutEvidenceDoNotKeepAPoseValid) {
  watch_.set_fresh(at(0ms));
  watch_.on_check(kNothingSeen, at(50s));
  EXPECT_FALSE(watch_.is_valid(at(61s)));
}

TEST_F(Watch, NoAgreeingPostureMakesAContestedPoseGood) {
  watch_.set_fresh(at(0ms));
  watch_.on_contested(true);
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_NE(watch_.reason(at(1s)).find("several postures"), std::string::npos);
  watch_.on_check(kAgrees, at(1s));
  EXPECT_FALSE(watch_.is_valid(at(1s)));
  watch_.on_contested(false);
  watch_.on_check(kAgrees, at(2s));
  EXPECT_TRUE(watch_.is_valid(at(2s)));
}

TEST_F(Watch, OneDisagreementEndsValidityAtOnceAndARowOfThemIsDrift) {
  watch_.set_fresh(at(0ms));
  watch_.on_check(kDisagrees, at(1s));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_FALSE(watch_.is_valid(at(1s)));
  drift();
  EXPECT_EQ(watch_.state(), PoseState::drifted);
}

TEST_F(Watch, DisagreementIsCheckedAgainSoon) {
  watch_.set_fresh(at(0ms));
  watch_.on_check(kAgrees, at(1s));
  EXPECT_FALSE(watch_.is_check_due(at(1900ms)));
  EXPECT_TRUE(watch_.is_check_due(at(2s)));
  watch_.on_check(kDisagrees, at(2s));
  EXPECT_TRUE(watch_.is_check_due(at(2100ms)));
}

TEST_F(Watch, FalseAlarmIsOverWithTheNextAgreement) {
  watch_.set_fresh(at(0ms));
  watch_.on_check(kDisagrees, at(1s));
  watch_.on_check(kAgrees, at(1100ms));
  EXPECT_TRUE(watch_.is_valid(at(1100ms)));
}

TEST_F(Watch, APoseThatIsOffByAsMuchAsTheLimitDoesNotFlap) {
  PoseCheck just{true, true, 0.9, 0.002, 4000};
  just.shift_sigmas = 3.8;
  watch_.set_fresh(at(0ms));
  for (int i = 0; i < 100; ++i) {
    watch_.on_check(i % 10 == 0 ? kDisagrees : just, at(1s + i * 100ms));
    ASSERT_FALSE(watch_.is_valid(at(1s + i * 100ms))) << i;
  }
  for (int i = 0; i < 20; ++i) watch_.on_check(just, at(11s + i * 100ms));
  EXPECT_TRUE(watch_.is_valid(at(13s))) << "so many on end are no chance";
}

TEST_F(Watch, DriftedPoseStaysSoHoweverOftenChecksAgreeUntilItIsSetAgain) {
  watch_.set_fresh(at(0ms));
  drift();
  ASSERT_EQ(watch_.state(), PoseState::drifted);
  for (int i = 0; i < 100; ++i) watch_.on_check(kAgrees, at(10s + i * 1s));
  EXPECT_EQ(watch_.state(), PoseState::drifted);
  EXPECT_FALSE(watch_.is_valid(at(110s)));
  EXPECT_NE(watch_.reason(at(110s)).find("activate"), std::string::npos);
  watch_.set_stored();
  watch_.on_check(kAgrees, at(111s));
  EXPECT_TRUE(watch_.is_valid(at(111s)));
}

TEST_F(Watch, DriftSurvivesARestart) {
  watch_.set_drifted();
  watch_.on_check(kAgrees, at(1s));
  EXPECT_EQ(watch_.state(), PoseState::drifted);
  EXPECT_NE(watch_.reason(at(1s)).find("before calibrd was started"), std::string::npos);
}

TEST_F(Watch, SomebodyPassingByIsNoDrift) {
  watch_.set_fresh(at(0ms));
  for (int i = 0; i < 20; ++i) watch_.on_check(kDisagrees, at(1s + i * 100ms));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  watch_.on_check(kAgrees, at(3100ms));
  EXPECT_TRUE(watch_.is_valid(at(3100ms)));
}

TEST_F(Watch, LostSensorEndsValidityAtOnceAndACheckAfterwardsBringsItBack) {
  watch_.set_fresh(at(0ms));
  watch_.on_sensor_lost();
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_FALSE(watch_.is_valid(at(1s)));
  EXPECT_NE(watch_.reason(at(1s)).find("lost"), std::string::npos);
  watch_.on_check(kNothingSeen, at(2s));
  EXPECT_FALSE(watch_.is_valid(at(2s)));
  watch_.on_check(kAgrees, at(3s));
  EXPECT_TRUE(watch_.is_valid(at(3s)));
}

TEST_F(Watch, LossOfTheSensorEndsNoDriftAndMakesNoPose) {
  watch_.on_sensor_lost();
  EXPECT_EQ(watch_.state(), PoseState::uncalibrated);
  watch_.set_drifted();
  watch_.on_sensor_lost();
  EXPECT_EQ(watch_.state(), PoseState::drifted);
}

TEST_F(Watch, WithheldPoseIsNotMadeValidByChecks) {
  watch_.set_withheld("the intrinsics have changed");
  for (int i = 0; i < 10; ++i) watch_.on_check(kAgrees, at(i * 1s));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_FALSE(watch_.is_valid(at(10s)));
  EXPECT_EQ(watch_.reason(at(10s)), "the intrinsics have changed");
  EXPECT_TRUE(watch_.last_check(at(10s))->agrees);
  watch_.set_fresh(at(11s));
  EXPECT_TRUE(watch_.is_valid(at(11s)));
}

TEST_F(Watch, MovedSensorIsDriftedAtOnceAndStaysSo) {
  watch_.set_fresh(at(0ms));
  watch_.on_sensor_moved();
  EXPECT_EQ(watch_.state(), PoseState::drifted);
  EXPECT_FALSE(watch_.is_valid(at(1ms)));
  watch_.on_background_in_place(at(1s));
  watch_.on_check(kAgrees, at(2s));
  EXPECT_EQ(watch_.state(), PoseState::drifted);
}

TEST_F(Watch, BackgroundInPlaceKeepsAPoseValidThatNoRobotIsThereToCheck) {
  watch_.set_fresh(at(0ms));
  watch_.on_background_in_place(at(50s));
  EXPECT_TRUE(watch_.is_valid(at(100s)));
  EXPECT_FALSE(watch_.is_valid(at(111s)));
}

TEST_F(Watch, BackgroundInPlaceMakesNoStoredPoseValid) {
  watch_.set_stored();
  watch_.on_background_in_place(at(1s));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
}

TEST_F(Watch, BackgroundInPlaceEndsTheDoubtAfterASensorWasLost) {
  watch_.set_fresh(at(0ms));
  watch_.on_sensor_lost();
  watch_.on_background_in_place(at(1s));
  EXPECT_TRUE(watch_.is_valid(at(1s)));
}

TEST_F(Watch, RobotThatDisagreesWhileTheBackgroundStandsIsNoDriftButNoValidPose) {
  watch_.set_fresh(at(0ms));
  for (int i = 0; i <= 60; ++i) {
    watch_.on_background_in_place(at(1s + i * 100ms));
    watch_.on_check(kDisagrees, at(1s + i * 100ms));
    EXPECT_FALSE(watch_.is_valid(at(1s + i * 100ms)));
  }
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_NE(watch_.reason(at(8s)).find("joint zeros"), std::string::npos);
}

TEST_F(Watch, BackgroundSeenLongBeforeTheDisagreementSaysNothingOfTheRobot) {
  watch_.set_fresh(at(0ms));
  watch_.on_background_in_place(at(1s));
  watch_.on_check(kDisagrees, at(10s));
  EXPECT_EQ(watch_.reason(at(10s)).find("joint zeros"), std::string::npos) << watch_.reason(at(10s));
}

TEST_F(Watch, WhatTheRobotHadAgainstASensorThatStoodIsNoBeginningOfDrift) {
  watch_.set_fresh(at(0ms));
  for (int i = 0; i < 100; ++i) {
    watch_.on_background_in_place(at(1s + i * 100ms));
    watch_.on_check(kDisagrees, at(1s + i * 100ms));
  }
  watch_.on_check(kDisagrees, at(13s));  // somebody hides the background
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  for (int i = 1; i <= 30; ++i) watch_.on_check(kDisagrees, at(13s + i * 100ms));
  EXPECT_EQ(watch_.state(), PoseState::drifted);
}

}  // namespace
}  // namespace calibrd
