// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/lateral_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/registration/linearization.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kLeast = 150;  // samples of each kind that tell their scatter
constexpr double kSlanted = 2.5;     // depth per pixel over axial sigma from which a surface is slanted
constexpr double kMost_px = 1.0, kStep_px = 0.1;

struct Scatter {
  double residual_m, axial_m, depth_per_pixel_m;
};

double whitened_scatter(const std::vector<Scatter>& all, double lateral_px) {
  std::vector<float> whitened;
  for (const Scatter& s : all) {
    const double lateral_m = lateral_px * s.depth_per_pixel_m;
    whitened.push_back(
        static_cast<float>(s.residual_m / std::sqrt(s.axial_m * s.axial_m + lateral_m * lateral_m)));
  }
  return robust_sigma(std::move(whitened));
}

}  // namespace

std::optional<double> find_lateral_noise(std::span<const Sample> samples, double lateral_px,
                                         double sigma_factor) {
  std::vector<Scatter> flat, slanted;
  for (const Sample& sample : samples) {
    const Observation& o = sample.observation;
    if (o.robust_weight <= 0) continue;
    const double sigma_m = o.sigma / sigma_factor, lateral_m = lateral_px * sample.depth_per_pixel_m;
    const double axial_m = std::sqrt(std::max(sigma_m * sigma_m - lateral_m * lateral_m, 1e-12));
    const bool is_slanted = sample.depth_per_pixel_m > kSlanted * axial_m;
    (is_slanted ? slanted : flat).push_back({o.residual, axial_m, sample.depth_per_pixel_m});
  }
  if (flat.size() < kLeast || slanted.size() < kLeast) return std::nullopt;
  for (double tried_px = 0; tried_px < kMost_px; tried_px += kStep_px)
    if (whitened_scatter(slanted, tried_px) <= whitened_scatter(flat, tried_px)) return tried_px;
  return kMost_px;
}

}  // namespace calibrd
