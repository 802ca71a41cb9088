// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/infrared_model.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::sim {
namespace {

// Noise of the counts: variance = kShot * counts + kRead^2.
constexpr float kShot = 1.0F, kRead = 20.0F;

}  // namespace

InfraredModel::InfraredModel(int width, int height, const NoiseField& noise)
    : width_(width), height_(height), noise_(noise), blurred_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void InfraredModel::blur(const PixelTruth& truth, const PixelRect& rect) {
  // Three taps (w, 1 - 2w, w) each way have the variance 2w: symmetric, so no edge moves.
  const auto side = static_cast<float>(0.5 * blur_px_ * blur_px_), middle = 1 - 2 * side;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const auto row = [&](int dy) {
        const float* in = &truth.echo[static_cast<std::size_t>(std::clamp(y + dy, 0, height_ - 1)) *
                                      static_cast<std::size_t>(width_)];
        return side * (in[std::max(x - 1, 0)] + in[std::min(x + 1, width_ - 1)]) + middle * in[x];
      };
      blurred_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
          side == 0 ? row(0) : side * (row(-1) + row(1)) + middle * row(0);
    }
}

void InfraredModel::measure(const PixelTruth& truth, const Tiles& changed, const InfraredErrors& errors,
                            Random& random, std::span<std::uint16_t> counts) {
  if (!made_ || errors.blur_px != blur_px_) {
    blur_px_ = errors.blur_px;
    blur(truth, {0, 0, width_, height_});
    made_ = true;
  } else {
    changed.each([&](const PixelRect& rect) { blur(truth, rect); });
  }
  const auto windows = noise_.choose(width_, height_, random);
  const auto gain = static_cast<float>(errors.gain), strength = static_cast<float>(errors.noise);
  const auto highest = static_cast<float>(errors.saturation);
  std::vector<float> noise(static_cast<std::size_t>(width_));
  for (int y = 0; y < height_; ++y) {
    noise_.row(windows, y, noise);
    const auto row = static_cast<std::size_t>(y) * noise.size();
    const float* __restrict__ in = &blurred_[row];
    std::uint16_t* __restrict__ out = &counts[row];
    for (std::size_t x = 0; x < noise.size(); ++x) {
      const float level = gain * in[x];
      const float value = level + strength * std::sqrt(kShot * level + kRead * kRead) * noise[x] + 0.5F;
      out[x] = static_cast<std::uint16_t>(static_cast<std::int32_t>(std::clamp(value, 0.0F, highest)));
    }
  }
}

}  // namespace calibrd::sim
