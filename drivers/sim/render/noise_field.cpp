// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/noise_field.hpp"

#include <numbers>

namespace calibrd::sim {
namespace {

constexpr std::size_t kN = NoiseField::kSize;

/// Sums over three neighbours of a ring along a stride, scaled so that the variance stays one.
std::vector<float> summed(const std::vector<float>& in, bool along_rows) {
  std::vector<float> out(in.size());
  for (std::size_t y = 0; y < kN; ++y)
    for (std::size_t x = 0; x < kN; ++x) {
      const auto at = [&](std::size_t step) {
        return along_rows ? in[y * kN + (x + step) % kN] : in[(y + step) % kN * kN + x];
      };
      out[y * kN + x] = (at(kN - 1) + at(0) + at(1)) / std::numbers::sqrt3_v<float>;
    }
  return out;
}

}  // namespace

NoiseField::NoiseField(bool correlated) : field_(kN * kN) {
  Random random(correlated ? 20150703 : 20131121);
  for (float& value : field_) value = static_cast<float>(random.normal() / std::numbers::sqrt2);
  if (correlated) field_ = summed(summed(field_, true), false);
}

NoiseField::Windows NoiseField::choose(int width, int height, Random& random) const {
  const auto place = [&] {
    const auto x = random.bits() % (kN - static_cast<std::size_t>(width) + 1);
    const auto y = random.bits() % (kN - static_cast<std::size_t>(height) + 1);
    return y * kN + x;
  };
  const std::size_t first = place();
  std::size_t second = place();
  while (second == first && (width < kSize || height < kSize)) second = place();
  return {first, second};
}

void NoiseField::row(const Windows& windows, int y, std::span<float> row) const {
  const float* a = &field_[windows.first + static_cast<std::size_t>(y) * kN];
  const float* b = &field_[windows.second + static_cast<std::size_t>(y) * kN];
  for (std::size_t x = 0; x < row.size(); ++x) row[x] = a[x] + b[x];
}

}  // namespace calibrd::sim
