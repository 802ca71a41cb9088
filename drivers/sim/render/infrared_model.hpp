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

/// The infrared image a time-of-flight sensor makes beside its depth, lit by its own lamp. Edges are as sharp as a
/// pixel's area and the lens's blur allow, and lie where they are. One thread.
class InfraredModel {
 public:
  /// `noise` (uncorrelated) must outlive it.
  InfraredModel(int width, int height, const NoiseField& noise);

  /// 16-bit counts. `changed`: where `truth` differs from the call before. Deterministic in `random`.
  void measure(const PixelTruth& truth, const Tiles& changed, const InfraredErrors& errors, Random& random,
               std::span<std::uint16_t> counts);

  /// The next call takes the whole image as changed: after a frame in which this one was not asked for.
  void forget() { made_ = false; }

 private:
  void blur(const PixelTruth& truth, const PixelRect& rect);

  int width_, height_;
  const NoiseField& noise_;
  double blur_px_ = 0;
  bool made_ = false;
  std::vector<float> blurred_;
};

}  // namespace calibrd::sim
