// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/window_support.hpp"

#include "tests/core/drift/pushed_box.hpp"

namespace calibrd {
namespace {

using namespace test;

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
