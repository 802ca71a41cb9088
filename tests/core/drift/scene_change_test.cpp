// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/scene_change.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace calibrd {
namespace {

constexpr int kWidth = 30;
constexpr std::size_t kCells = 900;
constexpr double kFrame_s = 1.0 / 30;

/// A picture of cells in which a square shows something else.
struct Picture {
  std::vector<CellState> states = std::vector<CellState>(kCells, CellState::same);
  std::vector<float> depth_m = std::vector<float>(kCells, 2);

  Picture& square(std::size_t left, CellState state, float depth) {
    for (std::size_t y = 10; y < 20; ++y)
      for (std::size_t x = left; x < left + 10; ++x) {
        states[y * kWidth + x] = state;
        depth_m[y * kWidth + x] = depth;
      }
    return *this;
  }
};

class SceneChanges : public ::testing::Test {
 protected:
  void show(double seconds, const std::function<Picture(double)>& picture_at,
            const std::vector<std::uint8_t>& ignored = {}) {
    for (const double end = now_s_ + seconds; now_s_ < end; now_s_ += kFrame_s) {
      const Picture picture = picture_at(now_s_);
      scene_.add(picture.states, picture.depth_m, ignored, now_s_);
    }
  }
  void show(double seconds, const Picture& picture, const std::vector<std::uint8_t>& ignored = {}) {
    show(
        seconds, [&](double) { return picture; }, ignored);
  }
  SceneChange scene_{SceneChangeSettings{}, kWidth};
  double now_s_ = 0;
};

TEST_F(SceneChanges, WhoPassesIsInFront) {
  show(10, [](double t) {
    const double depth = 1 + 0.3 * std::sin(2 * t);
    return Picture().square(10, CellState::nearer, static_cast<float>(depth));
  });
  EXPECT_TRUE(scene_.is_something_in_front());
  EXPECT_FALSE(scene_.has_changed());
}

TEST_F(SceneChanges, WhatIsGoneForASecondHasChanged) {
  show(0.8, Picture().square(10, CellState::farther, 3));
  EXPECT_FALSE(scene_.has_changed());
  show(0.4, Picture().square(10, CellState::farther, 3));
  EXPECT_TRUE(scene_.has_changed());
  EXPECT_FALSE(scene_.is_something_in_front());
}

TEST_F(SceneChanges, WhatHasComeMustStandLonger) {
  show(3.5, Picture().square(10, CellState::nearer, 1));
  EXPECT_FALSE(scene_.has_changed());
  EXPECT_TRUE(scene_.is_something_in_front());
  show(1, Picture().square(10, CellState::nearer, 1));
  EXPECT_TRUE(scene_.has_changed());
  EXPECT_FALSE(scene_.is_something_in_front());
}

TEST_F(SceneChanges, AMovedBoxIsHereSinceItIsNotThere) {
  show(1.5, Picture().square(2, CellState::farther, 3).square(16, CellState::nearer, 1));
  EXPECT_TRUE(scene_.has_changed());
  EXPECT_FALSE(scene_.is_something_in_front());
}

TEST_F(SceneChanges, HoldsWhileTheRobotHidesIt) {
  show(2, Picture().square(10, CellState::farther, 3));
  show(3, Picture().square(10, CellState::robot, 1));
  EXPECT_TRUE(scene_.has_changed());
}

TEST_F(SceneChanges, WhatTheRobotCarriesDoesNotCount) {
  std::vector<std::uint8_t> carried(kCells, 1);
  show(6, Picture().square(10, CellState::nearer, 1), carried);
  EXPECT_FALSE(scene_.has_changed());
  EXPECT_FALSE(scene_.is_something_in_front());
}

TEST_F(SceneChanges, FlickeringEdgesDoNotCount) {
  Picture line;
  for (std::size_t y = 0; y < 30; ++y) line.states[y * kWidth + 15] = CellState::farther;
  show(6, line);
  EXPECT_FALSE(scene_.has_changed());
}

TEST_F(SceneChanges, ANarrowPostCounts) {
  Picture post;
  for (std::size_t y = 5; y < 25; ++y)
    for (std::size_t x = 15; x < 17; ++x) post.states[y * kWidth + x] = CellState::farther;
  show(2, post);
  EXPECT_TRUE(scene_.has_changed());
}

TEST_F(SceneChanges, WhatNothingIsBehindLeavesDarknessForAMinute) {
  show(1, Picture());
  show(3, Picture().square(10, CellState::dark, 0));
  EXPECT_FALSE(scene_.has_changed());
  show(2, Picture().square(10, CellState::dark, 0));
  EXPECT_TRUE(scene_.has_changed());
  EXPECT_FALSE(scene_.is_something_in_front());
  show(60, Picture().square(10, CellState::dark, 0));
  EXPECT_FALSE(scene_.has_changed());
}

TEST_F(SceneChanges, PixelsThatFailNowAndThenAreNoDarkness) {
  int frame = 0;
  show(10, [&](double) { return ++frame % 30 == 0 ? Picture() : Picture().square(10, CellState::dark, 0); });
  EXPECT_FALSE(scene_.has_changed());
}

TEST_F(SceneChanges, GoesWhenAllIsAsItWas) {
  show(5, Picture().square(10, CellState::nearer, 1));
  show(0.1, Picture());
  EXPECT_FALSE(scene_.has_changed());
}

TEST_F(SceneChanges, ChoosesWhatStoodForLongWithItsMeanDepth) {
  show(5, Picture().square(10, CellState::nearer, 1));
  double sign = 1;
  show(3, [&](double) {
    sign = -sign;
    return Picture().square(10, CellState::nearer, static_cast<float>(1.004 + sign * 0.003));
  });
  EXPECT_EQ(scene_.unchanged_for(9)[15 * kWidth + 15], 0);
  const auto chosen = scene_.unchanged_for(7);
  EXPECT_EQ(chosen[15 * kWidth + 15], 1);
  EXPECT_EQ(chosen[15 * kWidth + 2], 0);  // as it was
  EXPECT_NEAR(scene_.mean_depth_m()[15 * kWidth + 15], 1.004, 1e-3);
  EXPECT_GE(scene_.mean_frames()[15 * kWidth + 15], 59);
}

}  // namespace
}  // namespace calibrd
