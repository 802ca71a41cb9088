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
/// Chance lets the cost fall by as much through an amplitude, a phase and the best of the periods once in a
/// hundred times.
constexpr double kSignificantGain = 0;
/// The cost has a wide minimum over periods: so many samples find it as well as all of them.
constexpr std::size_t kEnoughSamples = 20000;

struct Fit {
  double gain;  // how far the cost falls
  ParameterVector solution;
};

Fit fit_with(std::span<const RangeSample> samples, double sample_weight,
             const ParameterMatrix& rest_information, const ParameterVector& rest_gradient, double period_m) {
  ParameterMatrix information = rest_information;
  ParameterVector gradient = rest_gradient;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / kEnoughSamples);
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    const RangeSample& sample = samples[i];
    const Observation& o = sample.observation;
    const double weight = static_cast<double>(stride) * sample_weight * o.robust_weight / (o.sigma * o.sigma);
    ParameterVector jacobian = o.jacobian;
    const double phase = 2 * std::numbers::pi * sample.depth_m / period_m;
    jacobian[kSine] = std::sin(phase);
    jacobian[kCosine] = std::cos(phase);
    information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
    gradient += weight * o.residual * jacobian;
  }
  const ParameterMatrix full = information.selfadjointView<Eigen::Lower>();
  const ParameterVector solution = full.ldlt().solve(gradient);
  return {gradient.dot(solution), solution};
}

}  // namespace

std::optional<PeriodicTerm> find_period(std::span<const RangeSample> samples, double sample_weight,
                                        const ParameterMatrix& rest_information,
                                        const ParameterVector& rest_gradient) {
  // Without a periodic term: hold its amplitudes at 0.
  ParameterMatrix held = rest_information;
  held(kSine, kSine) += 1e12;
  held(kCosine, kCosine) += 1e12;
  const double base = fit_with(samples, sample_weight, held, rest_gradient, kCandidates_m[0]).gain;
  std::array<Fit, std::size(kCandidates_m)> fits;
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t i) {
    fits[i] = fit_with(samples, sample_weight, rest_information, rest_gradient, kCandidates_m[i]);
  });
  const auto best = std::ranges::max_element(fits, {}, &Fit::gain);
  if (best->gain <= base + kSignificantGain) return std::nullopt;
  return PeriodicTerm{kCandidates_m[best - fits.begin()], best->solution[kSine], best->solution[kCosine]};
}

}  // namespace calibrd
