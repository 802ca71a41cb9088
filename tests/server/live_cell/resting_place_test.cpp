// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/resting_place.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

RestingPlace::Sight sight(double along_m, double sigma_m, double turn_rad = 0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = along_m;
  pose.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  return {pose, sigma_m, 1e-4};
}

TEST(RestingPlaceTest, TheFirstSightOfAMoveIsNewAndTheOnesAfterItAreNot) {
  RestingPlace place;
  EXPECT_TRUE(place.is_new(sight(0.02, 0.0003)));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(place.is_new(sight(0.02 + 0.0003 * (i % 3), 0.0003))) << i;
}

TEST(RestingPlaceTest, ASensorThatGoesOnMovingIsNewAgain) {
  RestingPlace place;
  place.is_new(sight(0.02, 0.0003));
  EXPECT_TRUE(place.is_new(sight(0.03, 0.0003)));
  EXPECT_TRUE(place.is_new(sight(0.03, 0.0003, 0.01)));
}

TEST(RestingPlaceTest, ASlowMoveAddsUp) {
  RestingPlace place;
  place.is_new(sight(0, 0.0003));
  int times = 0;
  for (int i = 1; i <= 50; ++i) times += place.is_new(sight(0.001 * i, 0.0003));
  EXPECT_GE(times, 4);
}

/// Along a wall frames leap by what they do not know: whoever started over at each leap would never end.
TEST(RestingPlaceTest, FramesThatKnowLittleMayLeap) {
  RestingPlace place;
  place.is_new(sight(0.02, 0.003));
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(place.is_new(sight(i % 2 ? 0.012 : 0.029, 0.003))) << i;
  EXPECT_TRUE(place.is_new(sight(0.08, 0.003)));
}

TEST(RestingPlaceTest, ABetterLookMeasuresTheNext) {
  RestingPlace place;
  place.is_new(sight(0.02, 0.003));
  EXPECT_FALSE(place.is_new(sight(0.025, 0.0003)));
  EXPECT_TRUE(place.is_new(sight(0.034, 0.0003)));
}

TEST(RestingPlaceTest, AMomentWithoutASightIsNoMove) {
  RestingPlace place;
  place.is_new(sight(0.02, 0.0003));
  EXPECT_FALSE(place.is_new(std::nullopt));
  EXPECT_FALSE(place.is_new(sight(0.0203, 0.0003)));
  EXPECT_FALSE(place.is_new(std::nullopt));
  EXPECT_TRUE(place.is_new(sight(0.04, 0.0003)));
}

TEST(RestingPlaceTest, OfAnotherPoseItBeginsAnew) {
  RestingPlace place;
  place.is_new(sight(0.02, 0.0003));
  place.forget();
  EXPECT_TRUE(place.is_new(sight(0.02, 0.0003)));
}

}  // namespace
}  // namespace calibrd
