// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/window_support.hpp"

#include "tests/core/drift/watched_room.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kPushed_m = 0.008, kSlid_m = 0.0035;  // the robot's word agrees with the latter, too

/// Wall and floor leave open a slide along both, the sensor's x; the left faces of boxes show it. Sensor
/// axes.
Room corner(std::initializer_list<double> boxes_y) {
  Room room = Room::single_wall();
  room.blocks.push_back({{0, 1.1, 0}, {20, 0.1, 20}});
  for (const double y : boxes_y) room.blocks.push_back({{0.6, y, 1.15}, {0.4, 0.3, 0.9}});
  return room;
}

Pose in_sensor_axes(double x, double y, double z) {
  return true_T_base_sensor() * Pose(Eigen::Translation3d(x, y, z));
}

class PushedBox : public WatchedRoom {
 protected:
  explicit PushedBox(Room room = corner({0.3}), const DriftSettings& settings = {})
      : WatchedRoom(std::move(room), settings) {}
  BackgroundObservation seen_from(const Pose& T_base_sensor) {
    BackgroundMatcher matcher(watch_.background());
    const View view = room_.seen_from(T_base_sensor, joints_now());
    return matcher.match(view.depth, mask_of(room_, joints_now()), true_T_base_sensor().linear());
  }
  static double along_x(const Vector6d& shift) {
    return shift.tail<3>().dot(true_T_base_sensor().linear().col(0));
  }
  static double sigmas(const Vector6d& shift, const Matrix6d& covariance) {
    return std::sqrt(shift.dot(covariance.ldlt().solve(shift)));
  }
};

class AbsorbedBox : public PushedBox {
 protected:
  static DriftSettings quick() {
    DriftSettings settings;
    settings.absorb_s = 5;
    return settings;
  }
  AbsorbedBox() : PushedBox(corner({0.3}), quick()) {}
};

class TwoBoxes : public PushedBox {
 protected:
  TwoBoxes() : PushedBox(corner({0.3, -0.45})) {}
};

TEST_F(PushedBox, LooksLikeAMoveUntilItsPartOfTheImageIsLeftOut) {
  room_.blocks.back().middle.x() += kPushed_m;
  const auto seen = seen_from(true_T_base_sensor());
  ASSERT_TRUE(seen.has_evidence);
  EXPECT_GT(sigmas(seen.shift, seen.covariance), 4);
  EXPECT_LT(sigmas(seen.supported_shift, seen.supported_covariance), 2);
}

TEST_F(PushedBox, IsNoMoveOfTheSensor) {
  watch_for(4);
  const double largest = [&] {
    double statistic = 0;
    watch_for(6, [&] {
      if (frames_ % 6 == 0 && room_.blocks.back().middle.x() < 0.65)
        room_.blocks.back().middle.x() += kPushed_m;
      statistic = std::max(statistic, watch_.report().statistic);
    });
    return statistic;
  }();
  EXPECT_LT(largest, 0.5 * watch_.report().threshold);
  EXPECT_EQ(moved_at_frame_, -1);
}

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

TEST_F(TwoBoxes, TogetherShowAMoveAlongThatDirection) {
  const auto seen = seen_from(in_sensor_axes(kPushed_m, 0, 0));
  EXPECT_NEAR(along_x(seen.supported_shift), kPushed_m, 0.003);
  watch_for(4);
  moved_.tail<3>() = kPushed_m * true_T_base_sensor().linear().col(0);
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved);
}

/// Both boxes, the last blocks of the room.
class TakenBoxes : public TwoBoxes {
 protected:
  void push(double way_m) {
    for (auto block = room_.blocks.end() - 2; block != room_.blocks.end(); ++block)
      block->middle.x() += way_m;
  }
  static constexpr double kOutOfView_m = 30;
};

TEST_F(TakenBoxes, ThatComeBackElsewhereAreNoMove) {
  watch_for(4);
  push(kOutOfView_m);
  watch_for(3);
  push(kPushed_m - kOutOfView_m);
  watch_for(2);
  EXPECT_EQ(moved_at_frame_, -1);
  moved_.tail<3>() = 0.003 * true_T_base_sensor().linear().col(1);
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved) << "wall and floor tell of it";
}

TEST_F(TakenBoxes, ThatStandWhereTheyStoodSpeakAgain) {
  watch_for(4);
  push(kOutOfView_m);
  watch_for(3);
  push(-kOutOfView_m);
  watch_for(2);
  moved_.tail<3>() = kPushed_m * true_T_base_sensor().linear().col(0);
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved);
}

/// Nothing was seen for a while; then both boxes show a slide.
class SlideAfterDark : public TakenBoxes {
 protected:
  void darken() {
    watch_for(4);
    dark_share_ = 0.9;
    watch_for(3);
    dark_share_ = 0;
  }
};

TEST_F(SlideAfterDark, IsAMoveWhenTheRobotHasNothingToSay) {
  darken();
  push(kPushed_m);
  EXPECT_NE(watch_for(0.4), DriftVerdict::sensor_moved);
  EXPECT_TRUE(watch_.wants_check());
  EXPECT_FALSE(watch_.is_in_place());
  EXPECT_EQ(watch_for(0.8), DriftVerdict::sensor_moved);
}

TEST_F(SlideAfterDark, IsNoneWhenTheRobotDeniesItInTime) {
  darken();
  push(kPushed_m);
  watch_for(0.3);
  for (int asked = 0; asked < 5; ++asked) {
    check(Vector6d::Zero());
    watch_for(0.2);
  }
  EXPECT_EQ(moved_at_frame_, -1);
}

TEST_F(SlideAfterDark, IsAMoveAtOnceWhenTheRobotSaysSo) {
  darken();
  moved_.tail<3>() = kPushed_m * true_T_base_sensor().linear().col(0);
  watch_for(0.3);
  check(moved_);
  EXPECT_EQ(watch_for(0.1), DriftVerdict::sensor_moved);
}

TEST_F(PushedBox, AMoveThatWallAndFloorShowIsFound) {
  watch_for(4);
  moved_.tail<3>() = 0.003 * true_T_base_sensor().linear().col(1);
  EXPECT_EQ(watch_for(1.5), DriftVerdict::sensor_moved);
}

TEST_F(PushedBox, InTheLittleThatIsLeftOfTheBackgroundIsNoMoveEither) {
  watch_for(4);
  dark_share_ = 0.7;
  watch_for(1);
  room_.blocks.back().middle.x() += 0.04;
  watch_for(3);
  EXPECT_EQ(moved_at_frame_, -1);
}

TEST(WindowSupport, OfAgreeingTilesNoneIsMissed) {
  std::vector<TileSums> tiles(8 * 6);
  for (auto& tile : tiles) {
    tile.information.setIdentity();
    tile.gradient.setConstant(3);
  }
  const TiledFit fit{tiles, BackgroundVector::Zero(), BackgroundVector::Zero(), 1};
  const auto least = least_shift_without_a_window(fit, Matrix6d::Identity());
  ASSERT_TRUE(least);
  EXPECT_TRUE(least->solution.isApproxToConstant(3));
  EXPECT_TRUE(least->left_out.isApprox(9 * BackgroundMatrix::Identity()));
}

TEST(WindowSupport, TheOneThatPullsIsLeftOut) {
  std::vector<TileSums> tiles(8 * 6);
  for (auto& tile : tiles) tile.information.setIdentity();
  tiles[12].gradient.setConstant(50);
  const TiledFit fit{tiles, BackgroundVector::Zero(), BackgroundVector::Zero(), 1};
  const auto least = least_shift_without_a_window(fit, Matrix6d::Identity());
  ASSERT_TRUE(least);
  EXPECT_TRUE(least->solution.isZero(1e-9));
}

TEST(WindowSupport, NothingSeenHasNoSupport) {
  const std::vector<TileSums> tiles(8 * 6);
  const TiledFit fit{tiles, BackgroundVector::Zero(), BackgroundVector::Zero(), 1};
  EXPECT_FALSE(least_shift_without_a_window(fit, Matrix6d::Identity()));
}

}  // namespace
}  // namespace calibrd
