// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_match.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/core/drift/room.hpp"

namespace calibrd {
namespace {

using namespace test;

Vector6d delta(std::initializer_list<double> values) {
  Vector6d all;
  std::copy(values.begin(), values.end(), all.data());
  return all;
}

BackgroundObservation observed(Room& room, const BackgroundMap& map, const Vector6d& shift) {
  BackgroundMatcher matcher(map);
  const auto joints = postures(2)[1];
  const View view = room.seen_from(perturbed(true_T_base_sensor(), shift), joints);
  return matcher.match(view.depth, mask_of(room, joints), true_T_base_sensor().linear());
}

double chi2(const BackgroundObservation& seen, const Vector6d& truth) {
  const Vector6d error = seen.shift - truth;
  return error.dot(seen.covariance.ldlt().solve(error));
}

TEST(BackgroundMatcher, FindsSmallShiftsInBaseAxesWithTheirSigns) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  for (int axis = 0; axis < 6; ++axis) {
    for (const double size : {0.003, -0.003, 0.008}) {
      Vector6d shift = Vector6d::Zero();
      shift[axis] = size;
      const auto seen = observed(room, map, shift);
      ASSERT_TRUE(seen.has_evidence) << axis;
      EXPECT_NEAR(seen.shift[axis], size, 0.0015) << axis;
      EXPECT_LT((seen.shift - shift).tail<3>().norm(), 0.002) << axis;
      EXPECT_LT((seen.shift - shift).head<3>().norm(), 0.001) << axis;
    }
  }
}

TEST(BackgroundMatcher, ItsCovarianceHolds) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room, 6);
  double sum = 0;
  constexpr int kFrames = 40;
  const Vector6d shift = delta({0.001, -0.001, 0.0005, 0.001, 0.002, -0.001});
  BackgroundMatcher matcher(map);
  const auto joints = postures(2)[1];
  const auto mask = mask_of(room, joints);
  for (int i = 0; i < kFrames; ++i) {
    const View view = room.seen_from(perturbed(true_T_base_sensor(), shift), joints);
    sum += chi2(matcher.match(view.depth, mask, true_T_base_sensor().linear()), shift);
  }
  // 6 were it exact; the noise of the map comes on top, the same in all of them.
  EXPECT_GT(sum / kFrames, 1.5);
  EXPECT_LT(sum / kFrames, 14);
}

TEST(BackgroundMatcher, TellsTheRangeOffsetFromAMoveAlongTheOpticalAxis) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  room.offset_m = 0.006;
  auto seen = observed(room, map, Vector6d::Zero());
  EXPECT_NEAR(seen.offset_change_m, 0.006, 0.0015);
  EXPECT_LT(seen.shift.norm(), 0.002);
  Vector6d back = Vector6d::Zero();
  back.tail<3>() = -0.006 * true_T_base_sensor().linear().col(2);  // the depths grow, as with the offset
  room.offset_m = 0;
  seen = observed(room, map, back);
  EXPECT_NEAR(seen.offset_change_m, 0, 0.0015);
  EXPECT_LT((seen.shift - back).norm(), 0.002);
}

TEST(BackgroundMatcher, FortyPercentHiddenDoNotMatter) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  room.hidden_share = 0.4;
  const Vector6d shift = delta({0, 0.002, 0, 0.003, 0, -0.002});
  const auto seen = observed(room, map, shift);
  ASSERT_TRUE(seen.has_evidence);
  EXPECT_LT((seen.shift - shift).norm(), 0.004);
  EXPECT_LT(chi2(seen, shift), 40);
  EXPECT_NEAR(seen.share(CellState::nearer), 0.4, 0.1);
}

TEST(BackgroundMatcher, ADarkFrameIsNoEvidence) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  BackgroundMatcher matcher(map);
  View view = room.seen_from(true_T_base_sensor(), postures(1)[0]);
  std::ranges::fill(view.depth.raw, std::uint16_t{0});
  const auto seen = matcher.match(view.depth, {}, true_T_base_sensor().linear());
  EXPECT_FALSE(seen.has_evidence);
  EXPECT_GT(seen.share(CellState::dark), 0.99);
}

TEST(BackgroundMatcher, ASensorThatLooksElsewhereIsNoEvidence) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  EXPECT_FALSE(observed(room, map, delta({0, 0, 0.8, 0, 0, 0})).has_evidence);
}

TEST(BackgroundMatcher, SaysHowLittleASingleWallTells) {
  Room room = Room::single_wall();
  const BackgroundMap map = learnt(room);
  const auto seen = observed(room, map, Vector6d::Zero());
  ASSERT_TRUE(seen.has_evidence);
  const Eigen::Matrix3d axes = true_T_base_sensor().linear();
  const Eigen::Matrix3d shift = axes.transpose() * seen.covariance.bottomRightCorner<3, 3>() * axes;
  EXPECT_GT(std::sqrt(shift(0, 0)), 0.015);  // along the wall
  EXPECT_GT(std::sqrt(shift(1, 1)), 0.015);
  EXPECT_GT(std::sqrt(shift(2, 2)), 0.015);  // towards it: as good as a range offset
}

TEST(BackgroundMatcher, WhatIsGonePullsNothingAlong) {
  // A board a hand's breadth before the wall, taken away: the wall behind it is within the reach of a kernel
  // that could find a sensor moved far.
  Room room = Room::furnished();
  room.has_arm = false;
  room.blocks.push_back({{2.5, 0.4, 0.8}, {0.06, 1.2, 1.2}});
  room.blocks.push_back({{-2.5, 0.4, 0.8}, {0.06, 1.2, 1.2}});
  room.blocks.push_back({{0.3, 2.5, 0.8}, {1.2, 0.06, 1.2}});
  room.blocks.push_back({{0.3, -2.5, 0.8}, {1.2, 0.06, 1.2}});
  const BackgroundMap map = learnt(room);
  room.blocks.resize(room.blocks.size() - 4);
  const auto seen = observed(room, map, Vector6d::Zero());
  ASSERT_TRUE(seen.has_evidence);
  EXPECT_LT(seen.shift.head<3>().norm(), 0.001);
  EXPECT_LT(seen.shift.tail<3>().norm(), 0.0015);
}

TEST(BackgroundMatcher, KnowsHowMuchOfItsErrorIsTheMapsBesideWhatNoModelHas) {
  Room room = Room::furnished();
  room.has_arm = false;
  BackgroundMap one = learnt(room, 1), six = learnt(room, 6);
  EXPECT_NEAR(observed(room, one, Vector6d::Zero()).common_share, 0.05 + 1.0 / 2, 0.01);
  EXPECT_NEAR(observed(room, six, Vector6d::Zero()).common_share, 0.05 + 1.0 / 7, 0.01);
}

}  // namespace
}  // namespace calibrd
