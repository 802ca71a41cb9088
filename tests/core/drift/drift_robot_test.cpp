// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What the robot says beside the background.
#include "tests/core/drift/watched_room.hpp"

namespace calibrd {
namespace {

using namespace test;
using RobotsWord = WatchedRoom;

TEST_F(RobotsWord, BackgroundInPlaceAndRobotOffIsTheModel) {
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    for (int i = 0; i < 3; ++i) check(shifted(0.012, 0, 0));
  }
  watch_for(0.1);
  EXPECT_EQ(verdict(), DriftVerdict::robot_model_wrong);
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    check(Vector6d::Zero());
  }
  watch_for(0.1);
  EXPECT_EQ(verdict(), DriftVerdict::in_place);
}

TEST_F(RobotsWord, OnePostureAloneSaysNothing) {
  watch_for(0.5);
  for (int i = 0; i < 20; ++i) check(shifted(0.012, 0, 0));
  EXPECT_EQ(watch_for(0.1), DriftVerdict::in_place);
  EXPECT_TRUE(watch_.wants_check());
}

TEST_F(RobotsWord, WhatMovedAsOneIsTheSceneWhenTheRobotStands) {
  // The sensor's move stands for that of all it sees but the robot.
  watch_for(1);
  moved_ = shifted(0.012, 0, 0);
  const auto robot_stands = [&] { check(Vector6d::Zero()); };
  EXPECT_EQ(watch_for(1, robot_stands), DriftVerdict::scene_changed);
  EXPECT_LT(moved_at_frame_, 0);
  // Once it has stood for some seconds it is the background.
  EXPECT_EQ(watch_for(6, robot_stands), DriftVerdict::in_place);
  watch_for(3);
  EXPECT_LT(moved_at_frame_, 0);
}

TEST_F(RobotsWord, ItMustBeNewerThanWhatTheBackgroundSays) {
  watch_for(1);
  check(Vector6d::Zero());
  watch_for(0.1);
  moved_ = shifted(0.012, 0, 0);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(RobotsWord, ARobotThatMovedAlongConfirms) {
  watch_for(1);
  moved_ = shifted(0.006, 0, 0);
  EXPECT_EQ(watch_for(1, [&] { check(moved_); }), DriftVerdict::sensor_moved);
}

TEST_F(RobotsWord, WhereNothingIsInItsPlaceAndTheRobotNeitherTheSensorLooksElsewhere) {
  watch_for(1);
  room_.hidden_share = 1;
  EXPECT_NE(watch_for(3), DriftVerdict::sensor_moved);  // somebody may stand before it
  PoseCheck elsewhere;
  elsewhere.enough_evidence = true;
  watch_for(1.5, [&] { watch_.add_check(elsewhere, joints_now(), now_s_); });
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
}

TEST_F(RobotsWord, MomentsOfLookingElsewhereDoNotAddUp) {
  const auto room = room_.blocks;
  for (int moment = 0; moment < 3; ++moment) {
    for (Block& block : room_.blocks) block.middle *= 1.5;  // all lies farther
    room_.hidden_share = 0;
    EXPECT_NE(watch_for(0.2), DriftVerdict::sensor_moved) << moment;
    room_.blocks = room;
    room_.hidden_share = 1;
    EXPECT_NE(watch_for(10), DriftVerdict::sensor_moved) << moment;
  }
}

TEST_F(RobotsWord, WithoutBackgroundARobotThatIsOffMeansTheSensor) {
  watch_.set_pose(true_T_base_sensor());
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    for (int i = 0; i < 3; ++i) check(shifted(0.012, 0, 0));
  }
  watch_for(0.1);
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
}

TEST_F(RobotsWord, WithoutBackgroundARobotThatAgreesIsInPlace) {
  watch_.set_pose(true_T_base_sensor());
  watch_for(1);
  check(Vector6d::Zero());
  EXPECT_EQ(watch_for(0.5), DriftVerdict::in_place);
  EXPECT_FALSE(watch_.is_in_place());  // which is the background's word
}

class BeforeAWall : public WatchedRoom {
 protected:
  BeforeAWall() : WatchedRoom(Room::single_wall()) {}
  Vector6d along_the_wall(double by_m) const {
    Vector6d delta = Vector6d::Zero();
    delta.tail<3>() = by_m * true_T_base_sensor().linear().col(0);
    return delta;
  }
};

TEST_F(BeforeAWall, AloneItIsNoEvidence) {
  EXPECT_EQ(watch_for(6), DriftVerdict::no_evidence);
  EXPECT_FALSE(watch_.is_in_place());
}

TEST_F(BeforeAWall, TheRobotsWordHoldsForAWhileAsLongAsTheWallIsSeen) {
  watch_for(1);
  check(Vector6d::Zero());
  EXPECT_EQ(watch_for(5), DriftVerdict::in_place);
  EXPECT_EQ(watch_for(7), DriftVerdict::no_evidence);
  check(Vector6d::Zero());
  watch_for(0.1);
  dark_share_ = 1;
  EXPECT_EQ(watch_for(3), DriftVerdict::no_evidence);
}

TEST_F(BeforeAWall, TheRobotTellsOfAMoveThatTheWallDoesNotShow) {
  watch_for(1);
  check(Vector6d::Zero());
  EXPECT_EQ(watch_for(0.2), DriftVerdict::in_place);
  moved_ = along_the_wall(0.012);
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    for (int i = 0; i < 3; ++i) check(moved_);
  }
  watch_for(0.1);
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
}

TEST_F(BeforeAWall, WhatIsAnotherMoveInEachPostureIsTheModel) {
  watch_for(1);
  check(Vector6d::Zero());
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    check(along_the_wall(posture % 2 == 0 ? 0.012 : -0.012));
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::robot_model_wrong);
}

TEST_F(BeforeAWall, WhatMayBeTheModelOrTheSensorIsContestedUntilPosturesAgree) {
  watch_for(1);
  check(Vector6d::Zero());
  for (int posture = 0; posture < 3; ++posture) {
    watch_for(1);
    check(along_the_wall(posture % 2 == 0 ? 0.012 : -0.012));
  }
  ASSERT_EQ(watch_for(0.1), DriftVerdict::robot_model_wrong);
  EXPECT_TRUE(watch_.is_contested());
  for (int posture = 0; posture < 4; ++posture) {
    watch_for(1);
    check(Vector6d::Zero());
  }
  EXPECT_FALSE(watch_.is_contested());
}

TEST_F(RobotsWord, WhatTheBackgroundShowsToBeTheModelIsNotContested) {
  watch_for(2);
  for (int posture = 0; posture < 4; ++posture) {
    watch_for(1);
    check(shifted(0.012, 0, 0));
  }
  ASSERT_EQ(watch_for(0.1), DriftVerdict::robot_model_wrong);
  EXPECT_FALSE(watch_.is_contested());
}

TEST_F(BeforeAWall, WhatNoPostureTellsManyTellTogether) {
  moved_ = along_the_wall(0.0022);
  for (int posture = 0; posture < 4; ++posture) {
    watch_for(1);
    check(moved_);
  }
  EXPECT_NE(watch_for(0.1), DriftVerdict::sensor_moved);
  for (int posture = 0; posture < 8; ++posture) {
    watch_for(1);
    check(moved_);
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::sensor_moved);
}

TEST_F(BeforeAWall, WhatTheModelMayMakeOfManyPosturesIsNoMove) {
  for (int posture = 0; posture < 40; ++posture) {
    watch_for(1);
    check(along_the_wall(posture % 2 == 0 ? 0.0025 : -0.0015));
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::in_place);
}

TEST_F(RobotsWord, ManyPosturesTogetherSayNothingAgainstABackgroundThatStands) {
  for (int posture = 0; posture < 20; ++posture) {
    watch_for(1);
    check(shifted(0.0025, 0, 0));
  }
  EXPECT_EQ(watch_for(0.1), DriftVerdict::in_place);
}

TEST_F(BeforeAWall, WhatSlidesAlongItIsNoEvidenceOfAMove) {
  watch_for(1);
  room_.hidden_share = 0.85;
  double most = 0;
  watch_for(10, [&] { most = std::max(most, watch_.report().statistic); });
  EXPECT_NE(verdict(), DriftVerdict::sensor_moved);
  EXPECT_LT(most, 0.2 * watch_.report().threshold);
}

TEST_F(BeforeAWall, ATurnIsSeenByTheWallAlone) {
  watch_for(1);
  moved_.head<3>() = 0.004 * true_T_base_sensor().linear().col(0);
  EXPECT_EQ(watch_for(1), DriftVerdict::sensor_moved);
}

TEST_F(BeforeAWall, AKnockAfterWhichTheWallIsNowhereNearIsFoundByTheWallAlone) {
  watch_for(1);
  moved_.tail<3>() = 0.1 * true_T_base_sensor().linear().col(2);
  watch_for(0.5);
  EXPECT_GT(watch_.report().nearer, 0.9);
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved);
}

TEST_F(BeforeAWall, AFrameThatSeemsToShowItWhereItWasDoesNotBeginTheSearchAnew) {
  watch_for(2);
  const auto knock = turned(0.15, 0, 0);
  watch_for(1, [&] { moved_ = frames_ % 8 == 0 ? Vector6d(Vector6d::Zero()) : knock; });
  EXPECT_EQ(verdict(), DriftVerdict::sensor_moved);
}

TEST_F(BeforeAWall, ABoardHeldBeforeItIsNoKnock) {
  watch_for(1);
  room_.hidden_share = 0.7;
  EXPECT_EQ(watch_for(5), DriftVerdict::something_in_front);
}

TEST_F(RobotsWord, ViewsThatShowNoBackgroundChangeNothing) {
  watch_for(2);
  watch_.learn({});
  EXPECT_TRUE(watch_.has_background());
  EXPECT_EQ(watch_for(0.5), DriftVerdict::in_place);
}

}  // namespace
}  // namespace calibrd
