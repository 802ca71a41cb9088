// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/depth_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace calibrd::sim {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kHighest_mm = 65535;
constexpr double kLargestSigma_mm = 50;  // the formula grows without bound towards grazing incidence
constexpr std::uint16_t kAlways = 65535;

/// Systematic errors of one depth, the drift apart, in mm.
double biased_mm(const DepthErrors& e, double z_m) {
  const double wiggle = e.wiggle_m == 0 ? 0 : e.wiggle_m * std::sin(2 * std::numbers::pi * z_m / e.wiggle_period_m + e.wiggle_phase_rad);
  return 1000 * (e.scale * z_m + e.offset_m + wiggle);
}

std::uint16_t drop_chance(const DepthErrors& e, double incidence_rad) {
  double chance = e.dropout;
  const double beyond_deg = incidence_rad * kDegrees - e.grazing_deg;
  if (e.grazing_deg < 90 && beyond_deg > 0) chance += beyond_deg / (90 - e.grazing_deg);
  return static_cast<std::uint16_t>(std::min(1.0, chance) * kAlways);
}

std::uint16_t whole_mm(const DepthErrors& e, double depth_mm) {
  if (depth_mm < 1000 * e.min_range_m || depth_mm > 1000 * e.max_range_m || depth_mm < 0) return 0;
  return static_cast<std::uint16_t>(std::min(kHighest_mm, depth_mm + (e.truncated != 0 ? 0.0 : 0.5)));
}

}  // namespace

double axial_noise_m(double z_m, double incidence_rad) {
  const double theta = std::clamp(incidence_rad, 0.0, 0.5 * std::numbers::pi - 1e-3);
  const double grazing = theta / (0.5 * std::numbers::pi - theta);
  return 1e-3 * (1.5 - 0.5 * z_m + 0.3 * z_m * z_m + 0.1 * z_m * std::sqrt(z_m) * grazing * grazing);
}

DepthModel::DepthModel(int width, int height, const NoiseField& white, const NoiseField& correlated)
    : width_(width),
      height_(height),
      white_(white),
      correlated_(correlated),
      chance_(NoiseField::kSize * NoiseField::kSize) {
  Random random(424512);
  for (auto& chance : chance_) chance = static_cast<std::uint16_t>(random.bits());
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  biased_mm_.resize(pixels);
  sigma_mm_.resize(pixels);
  mixed_mm_.resize(pixels);
  drop_.resize(pixels);
}

void DepthModel::update(const PixelTruth& truth, const DepthErrors& errors, const PixelRect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      const double z = truth.depth_m[i];
      const double incidence = std::acos(std::min(1.0F, truth.cosine[i]));
      biased_mm_[i] = static_cast<float>(biased_mm(errors, z));
      sigma_mm_[i] = static_cast<float>(
          errors.noise == 0 ? 0 : errors.noise * std::min(kLargestSigma_mm, 1000 * axial_noise_m(z, incidence)));
      mixed_mm_[i] = truth.mixed_m[i] > 0 ? static_cast<float>(biased_mm(errors, truth.mixed_m[i])) : 0;
      drop_[i] = z > 0 ? drop_chance(errors, incidence) : kAlways;
    }
}

void DepthModel::add_noise(const DepthErrors& e, double drift_mm, Random& random, std::span<std::uint16_t> depth_mm) {
  const NoiseField& field = e.correlated != 0 ? correlated_ : white_;
  const auto windows = field.choose(width_, height_, random);
  const auto chances = field.choose(width_, height_, random).first;
  const auto low = static_cast<float>(1000 * e.min_range_m);
  const auto high = static_cast<float>(std::min(kHighest_mm, 1000 * e.max_range_m));
  const float rounding = e.truncated != 0 ? 0.0F : 0.5F;
  const auto shift = static_cast<float>(drift_mm);
  std::vector<float> noise(static_cast<std::size_t>(width_));
  for (int y = 0; y < height_; ++y) {
    field.row(windows, y, noise);
    const auto row = static_cast<std::size_t>(y) * noise.size();
    const float* __restrict__ biased = &biased_mm_[row];
    const float* __restrict__ sigma = &sigma_mm_[row];
    const std::uint16_t* __restrict__ drop = &drop_[row];
    const std::uint16_t* __restrict__ chance = &chance_[chances + static_cast<std::size_t>(y) * NoiseField::kSize];
    std::uint16_t* __restrict__ out = &depth_mm[row];
    for (std::size_t x = 0; x < noise.size(); ++x) {
      const float z = biased[x] + shift + sigma[x] * noise[x];
      const bool seen = (z >= low) & (z <= high) & (z >= 0.0F) & ((drop[x] == 0) | (chance[x] >= drop[x])) & (drop[x] != kAlways);
      out[x] = static_cast<std::uint16_t>(seen ? static_cast<std::int32_t>(z + rounding) : 0);
    }
  }
}

void DepthModel::add_edges(const DepthErrors& e, double drift_mm, Random& random, std::span<std::uint16_t> depth_mm) {
  if (e.flying_mixed == 0 && e.flying_dropped == 0) return;
  for (std::size_t i = 0; i < mixed_mm_.size(); ++i) {
    if (mixed_mm_[i] == 0) continue;
    const double lot = random.uniform();
    if (lot < e.flying_dropped) depth_mm[i] = 0;
    if (lot < e.flying_dropped || lot >= e.flying_dropped + e.flying_mixed) continue;
    depth_mm[i] = whole_mm(e, mixed_mm_[i] + drift_mm + sigma_mm_[i] * random.normal());
  }
}

void DepthModel::measure(const PixelTruth& truth, const Tiles& changed, const DepthErrors& errors, double age_s,
                         Random& random, std::span<std::uint16_t> depth_mm) {
  if (!made_ || errors != errors_) {
    update(truth, errors, {0, 0, width_, height_});
    errors_ = errors;
    made_ = true;
  } else {
    changed.each([&](const PixelRect& rect) { update(truth, errors, rect); });
  }
  const double drift_mm = 1000 * errors.warmup_m * std::exp(-age_s / errors.warmup_s);
  add_noise(errors, drift_mm, random, depth_mm);
  add_edges(errors, drift_mm, random, depth_mm);
}

}  // namespace calibrd::sim
