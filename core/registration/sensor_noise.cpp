// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/sensor_noise.hpp"

#include <algorithm>

#include "core/registration/lateral_noise.hpp"

namespace calibrd {
namespace {

/// Depth edges are found to half a pixel: most of them may agree to nothing, which says nothing of their
/// errors.
constexpr double kMinEdgeScatter = 0.5;
constexpr std::size_t kLateralSamples = 2000;  // tell the scatter well enough

}  // namespace

void SensorNoise::note_edges(const ViewSums& sums) {
  for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
    const auto& residuals_px = sums.contour[k].tally.residuals_px;
    if (!residuals_px.empty()) edges[k].sigma_px = robust_sigma(residuals_px);
  }
}

SensorNoise SensorNoise::found_in(const Linearization& around, const ViewSums& sums,
                                  const ParameterVector& range_alone) const {
  SensorNoise found = *this;
  found.range_correlation = sums.range.correlation_factor(range_alone);
  for (std::size_t k = 0; k < kEdgeSources.size(); ++k)
    found.edges[k].correlation = sums.contour[k].equations.correlation_factor();
  if (const auto px = find_lateral_noise(around.range_samples(kLateralSamples), lateral_px, sigma_factor))
    found.lateral_px = *px;
  found.sigma_factor = std::clamp(sigma_factor * robust_sigma(sums.range_tally.whitened), 0.3, 20.0);
  return found;
}

double SensorNoise::range_weight(const ViewSums& sums) const {
  const double scale = robust_sigma(sums.range_tally.whitened);
  return 1 / (scale * scale * range_correlation);
}

NormalEquations SensorNoise::weighed_edges(const ViewSums& sums) const {
  NormalEquations all;
  for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
    const double scale = std::max(robust_sigma(sums.contour[k].tally.whitened), kMinEdgeScatter);
    all.merge(sums.contour[k].equations.scaled(1 / (scale * scale * edges[k].correlation)));
  }
  return all;
}

NormalEquations SensorNoise::weighed(const ViewSums& sums) const {
  NormalEquations all = sums.range.scaled(range_weight(sums));
  all.merge(weighed_edges(sums));
  return all;
}

}  // namespace calibrd
