// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/sim/render/noise_field.hpp"
#include "drivers/sim/render/scene_renderer.hpp"
#include "drivers/sim/world/random.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// Standard deviation along the optical axis (m) of a Kinect v2: Fankhauser et al. 2015, eq. 6.
/// incidence_rad is between the surface's normal and the ray; z_m along the optical axis.
double axial_noise_m(double z_m, double incidence_rad);

/// Turns what is there into what a time-of-flight sensor says is there. One thread.
class DepthModel {
 public:
  /// Both fields must outlive it.
  DepthModel(int width, int height, const NoiseField& white, const NoiseField& correlated);

  /// The depth image in mm, 0 = no measurement. `changed`: where `truth` differs from the call before.
  /// `age_s`: since the sensor was switched on. Deterministic in `random`.
  void measure(const PixelTruth& truth, const Tiles& changed, const DepthErrors& errors, double age_s, Random& random,
               std::span<std::uint16_t> depth_mm);

 private:
  void update(const PixelTruth& truth, const DepthErrors& errors, const PixelRect& rect);
  void add_noise(const DepthErrors& errors, double drift_mm, Random& random, std::span<std::uint16_t> depth_mm);
  void add_edges(const DepthErrors& errors, double drift_mm, Random& random, std::span<std::uint16_t> depth_mm);

  int width_, height_;
  const NoiseField &white_, &correlated_;
  std::vector<std::uint16_t> chance_;  // uniform numbers to hold drop-outs against
  DepthErrors errors_;                 // that the planes below were made with
  bool made_ = false;
  std::vector<float> biased_mm_, sigma_mm_, mixed_mm_;
  std::vector<std::uint16_t> drop_;    // chance of no measurement, of 65535
};

}  // namespace calibrd::sim
