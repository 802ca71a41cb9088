// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_test.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace calibrd {
namespace {

constexpr double kSecondsPerYear = 365.25 * 86400;

/// Noise of a frame with that covariance, about a mean.
class Frames {
 public:
  Frames(const Matrix6d& covariance, std::uint64_t seed)
      : covariance_(covariance), root_(covariance.llt().matrixL()), random_(seed) {}
  void add_to(ShiftTest& test, const Vector6d& mean) {
    Vector6d unit;
    for (double& value : unit) value = normal_(random_);
    test.add(mean + root_ * unit, covariance_);
  }

 private:
  Matrix6d covariance_, root_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// One direction thrice as well known as the next, turned so that turn and shift go together.
Matrix6d anisotropic() {
  Vector6d sigma;
  sigma << 1e-4, 3e-4, 9e-4, 2e-4, 6e-4, 18e-4;
  Matrix6d mix = Matrix6d::Identity();
  mix(0, 4) = 0.3;
  mix(2, 3) = -0.5;
  mix(5, 1) = 0.4;
  return mix * sigma.cwiseAbs2().asDiagonal() * mix.transpose();
}

ShiftTestSettings alarming_every(double frames) {
  ShiftTestSettings settings;
  settings.false_alarms_per_year = settings.rate_hz * kSecondsPerYear / frames;
  return settings;
}

/// Mean frames to a false alarm of a sensor that stands `offset` from where it was.
double run_length(const ShiftTestSettings& settings, const Vector6d& offset, std::uint64_t seed) {
  constexpr int kAlarms = 25;
  Frames frames(anisotropic(), seed);
  double sum = 0;
  for (int i = 0; i < kAlarms; ++i) {
    ShiftTest test(settings);
    while (!test.is_alarmed()) {
      frames.add_to(test, offset);
      ++sum;
      if (sum > 40 * kAlarms * settings.rate_hz * kSecondsPerYear / settings.false_alarms_per_year)
        return sum;
    }
  }
  return sum / kAlarms;
}

/// Turn and shift each as large as the tolerance.
Vector6d at_tolerance(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Vector3d turn, shift;
  for (double& value : turn) value = normal(random);
  for (double& value : shift) value = normal(random);
  Vector6d offset;
  offset << 0.0005 * turn.normalized(), 0.0005 * shift.normalized();
  return offset;
}

int frames_to_alarm(const Vector6d& offset, std::uint64_t seed) {
  Frames frames(anisotropic(), seed);
  ShiftTest test{ShiftTestSettings{}};
  for (int i = 0; i < 300; ++i) frames.add_to(test, Vector6d::Zero());
  for (int i = 1; i < 200; ++i) {
    frames.add_to(test, offset);
    if (test.is_alarmed()) return i;
  }
  return 200;
}

TEST(ShiftTest, ThresholdIsSiegmunds) {
  // ARL = (exp(2k(h + 1.166)) - 2k(h + 1.166) - 1) / 2k²; k = 1, h = 10 gives 2.5e9, k = 0.5, h = 5 gives
  // 940.
  EXPECT_NEAR(cusum_threshold(1, 2.505e9), 10, 0.01);
  EXPECT_NEAR(cusum_threshold(0.5, 938), 5, 0.01);
  for (const double per_year : {10.0, 1.0, 0.1, 0.01}) {
    ShiftTestSettings settings;
    settings.false_alarms_per_year = per_year;
    const double reach = 2 * (ShiftTest(settings).threshold() + 1.166);
    EXPECT_NEAR((std::exp(reach) - reach - 1) / 2 / (30 * kSecondsPerYear / per_year), 1, 1e-6);
  }
}

TEST(ShiftTest, StandingSensorAlarmsNoMoreOftenThanStated) {
  const auto settings = alarming_every(1000);
  EXPECT_GT(run_length(settings, Vector6d::Zero(), 1), 1000);
  // Anywhere within the tolerance; the worst of it is what the limit is made for.
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_GT(run_length(settings, at_tolerance(seed), seed), 700) << seed;
}

TEST(ShiftTest, StatedRateIsNotFarFromTheTrueOneAtTheToleranceItself) {
  // All uncertainty along one axis, the shift as far along it as tolerated: increments of mean 0.
  Matrix6d covariance = Matrix6d::Identity() * 1e-12;
  covariance(5, 5) = 1e-6;
  const auto settings = alarming_every(300);
  double sum = 0;
  constexpr int kAlarms = 100;
  for (int i = 0; i < kAlarms; ++i) {
    Frames frames(covariance, static_cast<std::uint64_t>(i + 1));
    ShiftTest test(settings);
    Vector6d offset = Vector6d::Zero();
    offset[5] = 0.0005;
    for (int n = 0; n < 100000 && !test.is_alarmed(); ++n, ++sum) frames.add_to(test, offset);
  }
  EXPECT_GT(sum / kAlarms, 250);
  EXPECT_LT(sum / kAlarms, 30000);
}

TEST(ShiftTest, ThreeMillimetresAreFoundWithinSomeFrames) {
  for (int axis = 0; axis < 2; ++axis) {
    Vector6d offset = Vector6d::Zero();
    offset[3 + axis] = 0.003;
    EXPECT_LE(frames_to_alarm(offset, 3), 8) << axis;
    offset.setZero();
    offset[axis] = -0.003;
    EXPECT_LE(frames_to_alarm(offset, 4), 8) << axis;
  }
  // Where a frame tells little it takes more of them.
  Matrix6d covariance = Matrix6d::Identity() * 2.25e-6;
  Frames frames(covariance, 5);
  ShiftTest test{ShiftTestSettings{}};
  int needed = 0;
  for (; needed < 200 && !test.is_alarmed(); ++needed)
    frames.add_to(test, (Vector6d() << 0, 0, 0, 0.004, 0, 0).finished());
  EXPECT_GT(needed, 8);
  EXPECT_LE(needed, 60);
}

TEST(ShiftTest, OneOutlierNeverAlarms) {
  for (const double size : {0.01, 1.0, 1e6}) {
    Frames frames(anisotropic(), 6);
    ShiftTest test{ShiftTestSettings{}};
    for (int i = 0; i < 100; ++i) frames.add_to(test, Vector6d::Zero());
    test.add(Vector6d::Constant(size), anisotropic());
    EXPECT_FALSE(test.is_alarmed()) << size;
    EXPECT_LT(test.statistic(), 0.5 * test.threshold()) << size;
  }
}

TEST(ShiftTest, WhatAllFramesHaveInCommonDoesNotAddUp) {
  // The same 2 standard deviations in every frame: the noise of what they are compared with.
  const Matrix6d covariance = Matrix6d::Identity() * 4e-6;
  Vector6d common = Vector6d::Zero();
  common[3] = 0.004;
  ShiftTest knows{ShiftTestSettings{}}, does_not{ShiftTestSettings{}};
  Frames one(covariance, 8);
  for (int i = 0; i < 2000; ++i) {
    one.add_to(does_not, common);
    knows.add(common, covariance, 0.45);
  }
  EXPECT_TRUE(does_not.is_alarmed());
  EXPECT_FALSE(knows.is_alarmed());
}

TEST(ShiftTest, ResetForgets) {
  Frames frames(anisotropic(), 9);
  ShiftTest test{ShiftTestSettings{}};
  for (int i = 0; i < 50; ++i) frames.add_to(test, Vector6d::Constant(0.01));
  ASSERT_TRUE(test.is_alarmed());
  EXPECT_NEAR(test.mean()[3], 0.01, 1e-3);
  test.reset();
  EXPECT_EQ(test.statistic(), 0);
  EXPECT_EQ(test.mean(), Vector6d::Zero());
  for (int i = 0; i < 500; ++i) frames.add_to(test, Vector6d::Zero());
  EXPECT_FALSE(test.is_alarmed());
}

}  // namespace
}  // namespace calibrd
