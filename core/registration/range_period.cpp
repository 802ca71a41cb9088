// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/range_period.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace calibrd {
namespace {

// Modulation of 16 to 120 MHz and its harmonics wiggle with periods of this order; longer ones pass for a
// scale.
constexpr double kCandidates_m[] = {0.30, 0.36, 0.43, 0.50, 0.58, 0.66, 0.75, 0.85, 0.97, 1.10, 1.25};

/// Noise lets the cost fall by about as much through an amplitude and a phase: 2 for one period, more for the
/// best of several.
constexpr double kFallByChance = 3;

/// What is known without a periodic term: each candidate adds but its two rows.
struct Known {
  ParameterMatrix information;
  ParameterVector gradient;
};

struct Fit {
  double gain;  // how far the cost falls
  ParameterVector solution;
};

Fit solved(const Known& known) {
  const ParameterVector solution = known.information.ldlt().solve(known.gradient);
  return {known.gradient.dot(solution), solution};
}

Known without_period(std::span<const Sample> samples, double sample_weight, Known rest) {
  NormalEquations sums;
  for (const Sample& sample : samples) sums.add(sample.observation, 0);
  rest.information += sample_weight * ParameterMatrix(sums.information().selfadjointView<Eigen::Lower>());
  rest.gradient += sample_weight * sums.gradient();
  return rest;
}

Fit fit_with(std::span<const Sample> samples, double sample_weight, const Known& without, double period_m) {
  ParameterVector by_sine = ParameterVector::Zero(), by_cosine = ParameterVector::Zero();
  Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (const Sample& sample : samples) {
    const Observation& o = sample.observation;
    const double weight = sample_weight * o.robust_weight / (o.sigma * o.sigma);
    if (weight <= 0) continue;
    const double phase = 2 * std::numbers::pi * sample.depth_m / period_m;
    const Eigen::Vector2d wave(std::sin(phase), std::cos(phase));
    by_sine += weight * wave[0] * o.jacobian;
    by_cosine += weight * wave[1] * o.jacobian;
    own.noalias() += weight * wave * wave.transpose();
    pull += weight * o.residual * wave;
  }
  Known known = without;
  known.information.col(kSine) += by_sine;
  known.information.row(kSine) += by_sine.transpose();
  known.information.col(kCosine) += by_cosine;
  known.information.row(kCosine) += by_cosine.transpose();
  known.information.block<2, 2>(kSine, kSine) += own;
  known.gradient.segment<2>(kSine) += pull;
  return solved(known);
}

}  // namespace

std::optional<PeriodicTerm> find_period(std::span<const Sample> samples, double sample_weight,
                                        const ParameterMatrix& rest_information,
                                        const ParameterVector& rest_gradient) {
  const Known without = without_period(samples, sample_weight,
                                       {rest_information.selfadjointView<Eigen::Lower>(), rest_gradient});
  std::array<Fit, std::size(kCandidates_m)> fits;
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t i) {
    fits[i] = fit_with(samples, sample_weight, without, kCandidates_m[i]);
  });
  const auto best = std::ranges::max_element(fits, {}, &Fit::gain);
  // Of noise alone some candidate makes the cost fall, too: what is left of the amplitude without that is how
  // large it may be thought to be (James & Stein 1961).
  const double fall = best->gain - solved(without).gain;
  if (!(fall > kFallByChance)) return std::nullopt;
  const double left = 1 - kFallByChance / fall;
  const Eigen::Vector2d amplitude = best->solution.segment<2>(kSine);
  return PeriodicTerm{kCandidates_m[best - fits.begin()], amplitude[0], amplitude[1],
                      amplitude.norm() * std::sqrt(0.5 * left)};
}

}  // namespace calibrd
