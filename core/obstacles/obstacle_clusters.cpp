// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/obstacle_clusters.hpp"

#include <cmath>

namespace calibrd {
namespace {

class Grid {
 public:
  Grid(std::span<const float> depth_m, int width, float step_per_m)
      : depth_m_(depth_m),
        width_(static_cast<std::size_t>(width)),
        step_per_m_(step_per_m),
        open_(depth_m.size(), 0) {
    for (std::size_t cell = 0; cell + width_ + 1 < depth_m.size(); ++cell)
      if ((cell + 1) % width_ != 0) mark_block(cell);
  }

  std::vector<std::uint32_t> take_cluster(std::size_t seed) {
    std::vector<std::uint32_t> cluster;
    if (open_[seed] == 0) return cluster;
    open_[seed] = 0;
    cluster.push_back(static_cast<std::uint32_t>(seed));
    for (std::size_t next = 0; next < cluster.size(); ++next) {
      const std::size_t cell = cluster[next], column = cell % width_;
      if (column > 0) take(cell, cell - 1, cluster);
      if (column + 1 < width_) take(cell, cell + 1, cluster);
      if (cell >= width_) take(cell, cell - width_, cluster);
      if (cell + width_ < open_.size()) take(cell, cell + width_, cluster);
    }
    return cluster;
  }

 private:
  bool hang_together(std::size_t a, std::size_t b) const {
    const float near_m = depth_m_[a], other_m = depth_m_[b];
    return near_m > 0 && other_m > 0 && std::abs(near_m - other_m) < step_per_m_ * near_m;
  }
  void mark_block(std::size_t cell) {
    const std::size_t right = cell + 1, below = cell + width_, across = below + 1;
    if (!hang_together(cell, right) || !hang_together(cell, below) || !hang_together(right, across) ||
        !hang_together(below, across))
      return;
    open_[cell] = open_[right] = open_[below] = open_[across] = 1;
  }
  void take(std::size_t from, std::size_t cell, std::vector<std::uint32_t>& cluster) {
    if (open_[cell] == 0 || !hang_together(from, cell)) return;
    open_[cell] = 0;
    cluster.push_back(static_cast<std::uint32_t>(cell));
  }

  std::span<const float> depth_m_;
  std::size_t width_;
  float step_per_m_;
  std::vector<std::uint8_t> open_;  // in a block, and in no cluster yet
};

}  // namespace

std::vector<std::vector<std::uint32_t>> depth_clusters(std::span<const float> depth_m, int width,
                                                       float step_per_m, std::size_t least_cells) {
  Grid grid(depth_m, width, step_per_m);
  std::vector<std::vector<std::uint32_t>> clusters;
  for (std::size_t seed = 0; seed < depth_m.size(); ++seed)
    if (auto cluster = grid.take_cluster(seed); cluster.size() >= least_cells)
      clusters.push_back(std::move(cluster));
  return clusters;
}

}  // namespace calibrd
