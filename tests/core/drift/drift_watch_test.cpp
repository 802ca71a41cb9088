// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/drift_watch.hpp"

#include <set>
#include <string>

#include "tests/core/drift/watched_room.hpp"

namespace calibrd {
namespace {

using namespace test;
using DriftWatchTest = WatchedRoom;

TEST_F(DriftWatchTest, StandingSensorIsInPlace) {
  EXPECT_EQ(watch_for(4), DriftVerdict::in_place);
  EXPECT_TRUE(watch_.is_in_place());
  EXPECT_LT(watch_.report().statistic, 0.5 * watch_.report().threshold);
}

TEST_F(DriftWatchTest, MoveOf3mmIsFoundWithin15Frames) {
  for (const Vector6d& move : {shifted(0.003, 0, 0), shifted(0, -0.003, 0), shifted(0, 0, 0.003),
                               turned(0.003, 0, 0), turned(0, 0.003, 0), turned(0, 0, -0.003)}) {
    learn();
    moved_.setZero();
    moved_at_frame_ = -1;
    ASSERT_EQ(watch_for(1), DriftVerdict::in_place);
    const int before = frames_;
    moved_ = move;
    ASSERT_EQ(watch_for(0.6), DriftVerdict::sensor_moved) << move.transpose();
    EXPECT_LE(moved_at_frame_ - before, 15) << move.transpose();
    EXPECT_FALSE(watch_.is_in_place());
    ASSERT_TRUE(watch_.report().T_base_sensor_seen);
    const Vector6d error =
        difference(perturbed(true_T_base_sensor(), move), *watch_.report().T_base_sensor_seen);
    EXPECT_LT(error.tail<3>().norm(), 0.003) << move.transpose();
    EXPECT_LT(error.head<3>().norm(), 0.0015) << move.transpose();
  }
}

TEST_F(DriftWatchTest, AKnockIsFoundAndSaysWhereTo) {
  watch_for(1);
  moved_ << 0.02, -0.04, 0.02, 0.02, -0.015, 0.015;
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved);
  ASSERT_TRUE(watch_.report().T_base_sensor_seen);
  const Vector6d error =
      difference(perturbed(true_T_base_sensor(), moved_), *watch_.report().T_base_sensor_seen);
  EXPECT_LT(error.norm(), 0.015);
}

/// Whoever collects views after a knock starts over when the sensor is seen elsewhere again.
TEST_F(DriftWatchTest, AKnockedSensorThatStandsIsSeenInOnePlace) {
  watch_for(1);
  moved_ << 0, 0.035, 0, 0.02, 0, 0.01;
  const Pose truth = perturbed(true_T_base_sensor(), moved_);
  ASSERT_EQ(watch_for(0.2), DriftVerdict::sensor_moved);
  watch_for(8, [&] {
    ASSERT_TRUE(watch_.report().T_base_sensor_seen);
    const Vector6d error = difference(truth, *watch_.report().T_base_sensor_seen);
    EXPECT_LT(error.head<3>().norm(), 0.002) << now_s_;
    EXPECT_LT(error.tail<3>().norm(), 0.0025) << now_s_;
  });
}

TEST_F(DriftWatchTest, ASensorThatWasAwayIsInPlaceOnlyOnceSomeFramesSaySo) {
  for (const double by_m : {0.0, 0.02, -0.02, 0.004, -0.004}) {
    learn();
    moved_.setZero();
    watch_for(2);
    ASSERT_TRUE(watch_.is_in_place());
    now_s_ += 60;
    moved_ = shifted(by_m, 0, 0);
    int vouched = 0;
    watch_for(
        1, [&] { vouched += watch_.is_in_place() && watch_.report().verdict != DriftVerdict::no_evidence; });
    EXPECT_EQ(watch_.is_in_place(), by_m == 0) << by_m;
    EXPECT_LE(vouched, by_m == 0 ? 30 : 1) << by_m;  // before the first of these frames it still was
  }
}

TEST_F(DriftWatchTest, ASlowKnockIsFoundToo) {
  watch_for(1);
  EXPECT_EQ(watch_for(2, [&] { moved_[3] += 0.004 / 60; }), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, AKnockRightAfterLearningIsFound) {
  moved_ = shifted(0, 0.004, 0);
  EXPECT_EQ(watch_for(2), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, TwoSmallMovesAddUp) {
  watch_for(4);
  moved_ = shifted(0.0015, 0, 0);
  watch_for(3);
  moved_ = shifted(0.003, 0, 0);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, HavingMovedStaysUntilItLearnsAgain) {
  watch_for(1);
  moved_ = shifted(0.005, 0, 0);
  ASSERT_EQ(watch_for(1), DriftVerdict::sensor_moved);
  moved_.setZero();
  EXPECT_EQ(watch_for(3), DriftVerdict::sensor_moved);
  EXPECT_FALSE(watch_.is_in_place());
  learn();
  EXPECT_EQ(watch_for(1), DriftVerdict::in_place);
  EXPECT_TRUE(watch_.is_in_place());
}

TEST_F(DriftWatchTest, AnotherPoseHasNoBackgroundYet) {
  watch_for(1);
  watch_.set_pose(true_T_base_sensor());
  EXPECT_FALSE(watch_.has_background());
  EXPECT_EQ(watch_for(0.5), DriftVerdict::no_evidence);
  EXPECT_FALSE(watch_.is_in_place());
}

TEST_F(DriftWatchTest, WhoPassesIsInFront) {
  watch_for(1);
  EXPECT_EQ(watch_for(1.5, [&] { room_.hidden_share = 0.3 + 0.2 * std::sin(3 * now_s_); }),
            DriftVerdict::something_in_front);
  EXPECT_TRUE(watch_.is_in_place());
  room_.hidden_share = 0;
  EXPECT_EQ(watch_for(1), DriftVerdict::in_place);
}

TEST_F(DriftWatchTest, AKnockWhileSomebodyStandsInFrontIsFound) {
  room_.hidden_share = 0.4;
  watch_for(1);
  moved_ = shifted(0, 0.004, 0.003);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, WhatTheArmCarriesIsNothingInFront) {
  const auto tip = [&] {
    cell_.set_joints(joints_now());
    return Eigen::Vector3d(cell_.link_poses().back().translation());
  };
  room_.blocks.push_back({tip(), Eigen::Vector3d::Constant(0.16)});
  int in_front = 0;
  watch_for(6, [&] {
    room_.blocks.back().middle = tip();
    in_front += verdict() == DriftVerdict::something_in_front ? 1 : 0;
  });
  EXPECT_EQ(in_front, 0);
}

TEST_F(DriftWatchTest, ABoxTakenAwayIsAChangeOfTheScene) {
  watch_for(1);
  room_.blocks.erase(room_.blocks.begin() + 6);
  EXPECT_EQ(watch_for(2.5), DriftVerdict::scene_changed);
  EXPECT_TRUE(watch_.is_in_place());
}

TEST_F(DriftWatchTest, TheRangeThatWandersIsABias) {
  watch_for(1);
  EXPECT_EQ(watch_for(7, [&] { room_.offset_m = std::min(0.007, room_.offset_m + 1e-4); }),
            DriftVerdict::depth_bias_changed);
  EXPECT_NEAR(watch_.report().depth_offset_change_m, 0.007, 0.0015);
  EXPECT_TRUE(watch_.is_in_place());
}

TEST_F(DriftWatchTest, DarkIsNoEvidence) {
  watch_for(1);
  dark_share_ = 1;
  EXPECT_EQ(watch_for(1.5), DriftVerdict::no_evidence);
  EXPECT_FALSE(watch_.is_in_place());
  dark_share_ = 0;
  EXPECT_EQ(watch_for(1.5), DriftVerdict::in_place);
}

TEST_F(DriftWatchTest, WhatNeitherBackgroundNorRobotHasShownForTwoSecondsIsOutOfSight) {
  watch_for(3);
  EXPECT_FALSE(watch_.is_out_of_sight());
  room_.hidden_share = 1;
  watch_for(1.5);
  EXPECT_FALSE(watch_.is_out_of_sight());
  watch_for(1);
  EXPECT_TRUE(watch_.is_out_of_sight());
  check(Vector6d::Zero());
  watch_for(0.5);
  EXPECT_FALSE(watch_.is_out_of_sight());
  watch_for(2.5);
  EXPECT_TRUE(watch_.is_out_of_sight());
  room_.hidden_share = 0;
  watch_for(0.1);
  EXPECT_FALSE(watch_.is_out_of_sight());
}

TEST_F(DriftWatchTest, InTheDarkItIsOutOfSightAtOnce) {
  watch_for(3);
  dark_share_ = 1;
  watch_for(0.4);
  EXPECT_FALSE(watch_.is_out_of_sight());
  watch_for(0.3);
  EXPECT_TRUE(watch_.is_dark());
  EXPECT_TRUE(watch_.is_out_of_sight());
}

TEST_F(DriftWatchTest, WhereAMovedSensorIsIsToldNoLongerOnceItSeesNothingOfTheBackground) {
  watch_for(1);
  moved_ = shifted(0.03, 0, 0);
  watch_for(1);
  ASSERT_TRUE(watch_.report().T_base_sensor_seen);
  dark_share_ = 1;
  watch_for(1.5);
  EXPECT_FALSE(watch_.report().T_base_sensor_seen);
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, WithoutJointsTheRobotIsNoChangeOfTheScene) {
  watch_for(1);
  joints_lost_ = true;
  now_s_ = std::floor(now_s_);
  for (int i = 0; i < 6; ++i) {
    watch_for(1);
    now_s_ = 102;  // the arm stays where it is, time goes on behind the watch's back
  }
  EXPECT_NE(verdict(), DriftVerdict::scene_changed);
  EXPECT_NE(verdict(), DriftVerdict::sensor_moved);
  moved_ = shifted(0.004, 0, 0);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(DriftWatchTest, VerdictsHaveNamesAndTextsOfTheirOwn) {
  std::set<std::string> names, texts;
  for (std::size_t i = 0; i < kDriftVerdicts; ++i) {
    names.insert(name_of(static_cast<DriftVerdict>(i)));
    texts.insert(text_of(static_cast<DriftVerdict>(i)));
  }
  EXPECT_EQ(names.size(), kDriftVerdicts);
  EXPECT_EQ(texts.size(), kDriftVerdicts);
}

class AbsorbingRoom : public WatchedRoom {
 protected:
  static DriftSettings soon() {
    DriftSettings settings;
    settings.absorb_s = 6;
    return settings;
  }
  AbsorbingRoom() : WatchedRoom(Room::furnished(), soon()) {}
};

TEST_F(AbsorbingRoom, ABoxThatStandsBecomesBackground) {
  watch_for(1);
  room_.blocks.push_back({{-0.4, -0.4, 0.15}, {0.3, 0.3, 0.3}});
  ASSERT_EQ(watch_for(5.5), DriftVerdict::scene_changed);
  EXPECT_EQ(watch_for(16), DriftVerdict::in_place);
  moved_ = shifted(0, 0.004, 0);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(AbsorbingRoom, ABoxAbsorbedWhileTheRangeHasWanderedDoesNotPull) {
  watch_for(1);
  room_.offset_m = 0.007;
  watch_for(3);
  room_.blocks.push_back({{-0.3, -0.4, 0.25}, {0.6, 0.5, 0.5}});
  watch_for(18);
  EXPECT_NE(verdict(), DriftVerdict::scene_changed);
  room_.offset_m = 0;
  watch_for(4);
  EXPECT_LT(watch_.report().shift_m, 0.001);
  EXPECT_LT(watch_.report().statistic, 0.5 * watch_.report().threshold);
}

TEST_F(AbsorbingRoom, ACreepingSensorIsNotAbsorbed) {
  watch_for(4);
  room_.blocks.push_back({{-0.4, -0.4, 0.15}, {0.3, 0.3, 0.3}});
  double crept_m = 0;
  watch_for(40, [&] {
    if (verdict() == DriftVerdict::sensor_moved) return;
    crept_m += 0.003 / 1200;
    moved_ = shifted(crept_m, 0, 0);
  });
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
  EXPECT_LT(crept_m, 0.0015);
}

TEST_F(AbsorbingRoom, WhatASensorSeesThatMayBeElsewhereIsNotLearnt) {
  watch_for(1);
  room_.hidden_share = 1;  // a board before the lens, or a sensor that faces a wall
  for (int i = 0; i < 25; ++i) {
    watch_for(1);
    EXPECT_FALSE(i > 1 && watch_.is_in_place()) << i;
  }
  EXPECT_EQ(verdict(), DriftVerdict::something_in_front);
}

}  // namespace
}  // namespace calibrd
