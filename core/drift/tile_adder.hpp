// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/drift/window_support.hpp"

namespace calibrd {

/// Sums over the rows of one tile, in single precision over some of them, then in double.
class TileAdder {
 public:
  /// Of the depth by the parameters; an eighth, 0, makes two whole vectors of it.
  using Slope = Eigen::Matrix<float, kBackgroundParameters + 1, 1>;

  /// `tiles` must outlive it.
  explicit TileAdder(std::vector<TileSums>& tiles) : tiles_(tiles) {}
  ~TileAdder() { flush(); }

  void begin(std::size_t tile) {
    if (tile == tile_) return;
    flush();
    tile_ = tile;
  }
  void add(const Slope& slope, float weight, float residual) {
    const Slope weighted = weight * slope;
    products_.noalias() += weighted * slope.transpose();
    gradient_ += residual * weighted;
    if (++pending_ == kRowsInSingle) flush();
  }

 private:
  using Products = Eigen::Matrix<float, kBackgroundParameters + 1, kBackgroundParameters + 1>;
  static constexpr std::size_t kRowsInSingle = 128;

  void flush() {
    if (pending_ == 0) return;
    tiles_[tile_].information +=
        products_.topLeftCorner<kBackgroundParameters, kBackgroundParameters>().cast<double>();
    tiles_[tile_].gradient += gradient_.head<kBackgroundParameters>().cast<double>();
    products_.setZero();
    gradient_.setZero();
    pending_ = 0;
  }

  std::vector<TileSums>& tiles_;
  Products products_ = Products::Zero();
  Slope gradient_ = Slope::Zero();
  std::size_t pending_ = 0, tile_ = 0;
};

}  // namespace calibrd
