// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/point_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

/// 16 MB of cells: beyond that a larger cell is cheaper than the memory it saves.
constexpr double kMostCells = 1 << 22;

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, float cell_m) : cell_m_(cell_m) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  if (points.empty()) box.extend(Eigen::Vector3f::Zero());
  origin_ = box.min();
  const auto cells_at = [&](float side) {
    return ((box.sizes() / side).array().floor() + 1).cast<double>().prod();
  };
  while (cells_at(cell_m_) > kMostCells) cell_m_ *= 1.5F;
  inverse_cell_ = 1 / cell_m_;
  size_ = cell_of(box.max()) + Cell::Ones();

  std::vector<std::uint32_t> cells(points.size());
  starts_.assign(static_cast<std::size_t>(size_.z()) * row_start(0, 1) + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Cell cell = cell_of(points[i]);
    cells[i] = static_cast<std::uint32_t>(row_start(cell.y(), cell.z()) + static_cast<std::size_t>(cell.x()));
    ++starts_[cells[i]];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& start : starts_) start = sum += start;
  points_.resize(points.size());
  order_.resize(points.size());
  // Filling each cell from its end leaves every entry at its cell's first point.
  for (std::size_t i = points.size(); i-- > 0;) {
    const std::uint32_t place = --starts_[cells[i]];
    points_[place] = points[i];
    order_[place] = static_cast<std::uint32_t>(i);
  }
}

PointGrid::Cell PointGrid::cell_of(const Eigen::Vector3f& point) const {
  return ((point - origin_) * inverse_cell_).cast<int>();  // never negative: truncating is flooring
}

/// Looks into every cell that may hold something nearer than `best`.
void PointGrid::search_cells_around(const Eigen::Vector3f& query, Neighbour& best) const {
  const Eigen::Array3f place = (query - origin_).array();
  const float reach = std::sqrt(best.squared_distance);
  const Eigen::Array3i top = size_.array() - 1;
  // Truncating is flooring here: what lies below 0 ends at 0 either way.
  const Eigen::Array3i low = ((place - reach) * inverse_cell_).cast<int>().max(0).min(top);
  const Eigen::Array3i high = ((place + reach) * inverse_cell_).cast<int>().max(0).min(top);
  // How far the query is from the row along one axis: 0 while it is beside the row.
  const auto gap = [&](int cell, int axis) {
    const float from = static_cast<float>(cell) * cell_m_;
    return std::max({from - place[axis], place[axis] - from - cell_m_, 0.0F});
  };
  for (int z = low.z(); z <= high.z(); ++z) {
    const float gap_z = gap(z, 2);
    for (int y = low.y(); y <= high.y(); ++y) {
      const float gap_y = gap(y, 1);
      if (gap_y * gap_y + gap_z * gap_z < best.squared_distance)
        search(query, range(low.x(), high.x(), y, z), best);
    }
  }
}

PointGrid::Neighbour PointGrid::nearest(const Eigen::Vector3f& query, float reach_m, int hint) const {
  const Neighbour nothing{-1, reach_m * reach_m};
  Neighbour best = nothing;
  const Eigen::Array3f place = (query - origin_).array();
  const Eigen::Array3f extent = size_.array().cast<float>() * cell_m_;
  // Further outside than the reach: nothing. This also keeps cell numbers in the range of int.
  if ((place < -reach_m).any() || (place > extent + reach_m).any()) return nothing;
  if (hint >= 0)
    search(query, {static_cast<std::uint32_t>(hint), static_cast<std::uint32_t>(hint) + 1}, best);
  // Without a near hint the reach grows until something is found in it.
  for (float reach = 0.5F * cell_m_; best.index < 0 && reach < reach_m; reach *= 2) {
    best.squared_distance = reach * reach;
    search_cells_around(query, best);
    if (best.index >= 0) return best;
    best = nothing;
  }
  search_cells_around(query, best);
  return best;
}

}  // namespace calibrd
