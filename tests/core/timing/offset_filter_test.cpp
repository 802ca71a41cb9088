// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/offset_filter.hpp"

#include <gtest/gtest.h>

#include <random>

namespace calibrd {
namespace {

/// A frame of a sensor whose pose is off by `pose_m` along x: what moves at `speed_m_s` along x looks
/// displaced by both.
OffsetEquations frame(double speed_m_s, double offset_s, double pose_m, std::mt19937& random,
                      double noise_m = 0.002) {
  OffsetSums sums(20);
  std::normal_distribution<double> noise(0, noise_m);
  for (std::size_t i = 0; i < 400; ++i) {
    OffsetVector jacobian = OffsetVector::Zero();
    const double across = 0.5 + 0.001 * static_cast<double>(i);
    jacobian << speed_m_s * across, 0, 0.3, 0, across, 0.2, 0.1, 0;
    const double value = jacobian[0] * offset_s + across * pose_m + noise(random);
    sums.add(jacobian, value, value - jacobian[0] * offset_s, noise_m, 1, i / 20);
  }
  return sums.equations();
}

TEST(OffsetFilter, ToAndFroTellsTheOffsetFromThePose) {
  OffsetFilter filter;
  std::mt19937 random(1);
  for (int i = 0; i < 60; ++i) filter.add(frame(i % 6 < 3 ? 0.3 : -0.3, 0.04, 0.001, random), 0.25 * i);
  const auto estimate = filter.estimate();
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->offset_s, 0.04, 0.002);
  EXPECT_LT(estimate->sigma_s, 0.002);
}

TEST(OffsetFilter, MotionInOneDirectionLeavesThePoseInTheSigma) {
  OffsetFilter filter;
  std::mt19937 random(2);
  for (int i = 0; i < 60; ++i) filter.add(frame(0.3, 0.04, 0.0015, random), 0.25 * i);
  const auto estimate = filter.estimate();
  ASSERT_TRUE(estimate);
  EXPECT_LT(std::abs(estimate->offset_s - 0.04), 2.5 * estimate->sigma_s);
  EXPECT_GT(estimate->sigma_s, 0.003);  // 1.5 mm at 0.3 m/s are 5 ms
}

TEST(OffsetFilter, SigmaFollowsHowBlocksScatter) {
  std::mt19937 random(3);
  std::normal_distribution<double> wandering(0, 0.012);
  OffsetFilter steady, shaken;
  for (int i = 0; i < 80; ++i) {
    const double speed = i % 2 ? 0.3 : -0.3;
    steady.add(frame(speed, 0.02, 0, random), 0.5 * i);
    shaken.add(frame(speed, 0.02 + wandering(random), 0, random), 0.5 * i);
  }
  ASSERT_TRUE(steady.estimate() && shaken.estimate());
  EXPECT_GT(shaken.estimate()->sigma_s, 2 * steady.estimate()->sigma_s);
  EXPECT_LT(std::abs(shaken.estimate()->offset_s - 0.02), 3 * shaken.estimate()->sigma_s);
}

TEST(OffsetFilter, JitterOfSingleFramesIsSeen) {
  std::mt19937 random(4);
  std::normal_distribution<double> late(0, 0.006);
  OffsetFilter steady, jittering;
  for (int i = 0; i < 200; ++i) {
    const double speed = i % 8 < 4 ? 0.3 : -0.3;
    steady.add(frame(speed, 0.02, 0, random), 0.1 * i);
    jittering.add(frame(speed, 0.02 + late(random), 0, random), 0.1 * i);
  }
  EXPECT_LT(steady.estimate()->jitter_s, 0.002);
  EXPECT_NEAR(jittering.estimate()->jitter_s, 0.006, 0.0025);
}

TEST(OffsetFilter, OneWildBlockChangesNothingAndManyMeanAnotherOffset) {
  std::mt19937 random(5);
  OffsetFilter filter;
  int i = 0;
  for (; i < 40; ++i) filter.add(frame(i % 2 ? 0.3 : -0.3, 0.02, 0, random), 0.5 * i);
  const double before = filter.estimate()->offset_s;
  filter.add(frame(0.3, 0.09, 0, random), 0.5 * i++);
  filter.add(frame(-0.3, 0.02, 0, random), 0.5 * i++);
  filter.add(frame(0.3, 0.02, 0, random), 0.5 * i++);
  EXPECT_NEAR(filter.estimate()->offset_s, before, 0.001);
  EXPECT_FALSE(filter.is_lost());
  for (int k = 0; k < 10; ++k, ++i) filter.add(frame(i % 2 ? 0.3 : -0.3, 0.09, 0, random), 0.5 * i);
  EXPECT_TRUE(filter.is_lost());
}

TEST(OffsetFilter, SaysNothingBeforeItHasSeenEnough) {
  std::mt19937 random(6);
  OffsetFilter filter;
  for (int i = 0; i < 5; ++i) filter.add(frame(0.3, 0.02, 0, random), 0.5 * i);
  EXPECT_FALSE(filter.estimate());
}

}  // namespace
}  // namespace calibrd
