// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/sim/world/random.hpp"

namespace calibrd::sim {

/// Standard normal noise for whole images, cheaply: each image is the sum of two windows, at random places, of a
/// field made once. Neighbouring pixels are independent, or correlated as an average over 3x3 pixels makes them.
class NoiseField {
 public:
  explicit NoiseField(bool correlated);

  static constexpr int kSize = 1024;  ///< images may be this wide and high

  struct Windows {
    std::size_t first, second;  // offsets into the field
  };
  Windows choose(int width, int height, Random& random) const;

  /// Noise of row `y` into `row`.
  void row(const Windows& windows, int y, std::span<float> row) const;

 private:
  std::vector<float> field_;
};

}  // namespace calibrd::sim
