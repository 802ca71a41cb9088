// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/range_period.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace calibrd {
namespace {

/// Residuals of a sensor that wiggles: noise of 1.5 mm on pixels between 0.9 and 1.9 m.
std::vector<Sample> wiggling(double amplitude_m, double period_m, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> depth(0.9, 1.9);
  std::vector<Sample> samples;
  for (int i = 0; i < 20000; ++i) {
    Sample sample;
    sample.depth_m = depth(random);
    sample.observation.jacobian.setZero();
    for (int k = 0; k < 6; ++k) sample.observation.jacobian[k] = normal(random);
    sample.observation.jacobian[kOffset] = 1;
    sample.observation.jacobian[kScale] = sample.depth_m;
    sample.observation.sigma = 0.0015;
    const double phase = 2 * std::numbers::pi * sample.depth_m / period_m;
    sample.observation.residual = 0.0015 * normal(random) + amplitude_m * std::sin(phase + 0.7);
    samples.push_back(sample);
  }
  return samples;
}

ParameterMatrix weak_priors() {
  ParameterMatrix information = ParameterMatrix::Identity();
  information(kSine, kSine) = information(kCosine, kCosine) = 1 / (0.004 * 0.004);
  return information;
}

TEST(RangePeriod, FindsThePeriodThatWasPutIn) {
  for (const double period_m : {0.36, 0.66}) {
    const auto term = find_period(wiggling(0.003, period_m), 1, weak_priors(), ParameterVector::Zero());
    ASSERT_TRUE(term);
    EXPECT_NEAR(term->period_m, period_m, 0.08 * period_m);
    EXPECT_NEAR(std::hypot(term->sin_m, term->cos_m), 0.003, 0.0008);
    EXPECT_NEAR(std::atan2(term->cos_m, term->sin_m), 0.7,
                0.4);  // sin(φ + 0.7) = cos 0.7 sin φ + sin 0.7 cos φ
  }
}

TEST(RangePeriod, OfNothingButNoiseIsOfNoSize) {
  int found = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const auto term = find_period(wiggling(0, 0.5, seed), 1, weak_priors(), ParameterVector::Zero());
    if (!term) continue;
    ++found;
    EXPECT_LT(std::hypot(term->sin_m, term->cos_m), 0.0001);
    EXPECT_LT(term->prior_m, 0.0001);
  }
  EXPECT_LT(found, 6);
}

}  // namespace
}  // namespace calibrd
