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

TEST_F(Watch, OneDisagreementEndsValidityAtOnceAndARowOfThemIsDrift) {
  watch_.set_fresh(at(0ms));
  watch_.on_check(kDisagrees, at(1s));
  EXPECT_EQ(watch_.state(), PoseState::unverified);
  EXPECT_FALSE(watch_.is_valid(at(1s)));
  for (int i = 1; i < 5; ++i) watch_.on_check(kDisagrees, at(1s + i * 100ms));
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

TEST_F(Watch, DriftedPoseNeedsARowOfAgreements) {
  watch_.set_fresh(at(0ms));
  for (int i = 0; i < 5; ++i) watch_.on_check(kDisagrees, at(1s));
  watch_.on_check(kAgrees, at(2s));
  watch_.on_check(kAgrees, at(3s));
  watch_.on_check(kDisagrees, at(4s));
  watch_.on_check(kAgrees, at(5s));
  watch_.on_check(kAgrees, at(6s));
  EXPECT_EQ(watch_.state(), PoseState::drifted);
  watch_.on_check(kAgrees, at(7s));
  EXPECT_TRUE(watch_.is_valid(at(7s)));
}

}  // namespace
}  // namespace calibrd
