// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calibrd {

/// A point cloud laid out cell by cell of a regular grid: neighbours lie together in memory, so searching
/// within about a cell costs a fraction of what a tree asks for. Immutable: safe to search from any thread.
class PointGrid {
 public:
  struct Range {
    std::uint32_t begin = 0, end = 0;  ///< indices of points()
  };
  struct Neighbour {
    int index = -1;  ///< of points(); -1 = none in reach
    float squared_distance = 0;
  };

  PointGrid() : PointGrid({}, 1) {}
  /// Points within 100 km, m. Cells become larger than `cell_m` when a wide cloud would need too many of
  /// them.
  PointGrid(std::span<const Eigen::Vector3f> points, float cell_m);

  const std::vector<Eigen::Vector3f>& points() const { return points_; }  ///< cell by cell
  const std::vector<std::uint32_t>& order() const {
    return order_;
  }  ///< for each of points(), its place in the cloud given
  float cell_m() const { return cell_m_; }

  /// The nearest point closer than `reach_m`. `hint`: a point supposed to be near (-1: none), as the partner
  /// of the last step is; it saves most of the search and does not change its result.
  Neighbour nearest(const Eigen::Vector3f& query, float reach_m, int hint = -1) const;

  /// Calls visit(own, block) for every cell that holds points: its own points, and the rows of points that
  /// hold all of their neighbours within a cell's side (and some more). Rows of cells run along x.
  template <class Visit>
  void for_each_cell(int first_row, int last_row, Visit&& visit) const;
  int rows() const { return size_.y() * size_.z(); }

 private:
  using Cell = Eigen::Vector3i;
  Cell cell_of(const Eigen::Vector3f& point) const;
  std::size_t row_start(int y, int z) const {
    return static_cast<std::size_t>(z * size_.y() + y) * static_cast<std::size_t>(size_.x());
  }
  /// Points of the cells x_first..x_last of a row, all inside the grid.
  Range range(int x_first, int x_last, int y, int z) const {
    const std::size_t row = row_start(y, z);
    return {starts_[row + static_cast<std::size_t>(x_first)],
            starts_[row + static_cast<std::size_t>(x_last) + 1]};
  }
  void search_cells_around(const Eigen::Vector3f& query, Neighbour& best) const;
  void search(const Eigen::Vector3f& query, Range range, Neighbour& best) const {
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const float squared = (points_[i] - query).squaredNorm();
      if (squared < best.squared_distance) best = {static_cast<int>(i), squared};
    }
  }

  float cell_m_, inverse_cell_ = 0;
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Cell size_ = Cell::Ones();
  std::vector<std::uint32_t> starts_;  // first point of each cell, and the end
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> order_;
};

template <class Visit>
void PointGrid::for_each_cell(int first_row, int last_row, Visit&& visit) const {
  std::array<Range, 9> block;
  for (int row = first_row; row < last_row; ++row) {
    const int y = row % size_.y(), z = row / size_.y();
    const Range whole = range(0, size_.x() - 1, y, z);
    if (whole.begin == whole.end) continue;
    for (int x = 0; x < size_.x(); ++x) {
      const Range own = range(x, x, y, z);
      if (own.begin == own.end) continue;
      std::size_t count = 0;
      const int left = std::max(x - 1, 0), right = std::min(x + 1, size_.x() - 1);
      for (int v = std::max(z - 1, 0); v <= std::min(z + 1, size_.z() - 1); ++v) {
        for (int u = std::max(y - 1, 0); u <= std::min(y + 1, size_.y() - 1); ++u) {
          const Range part = range(left, right, u, v);
          if (part.begin != part.end) block[count++] = part;
        }
      }
      visit(own, std::span<const Range>(block.data(), count));
    }
  }
}

}  // namespace calibrd
