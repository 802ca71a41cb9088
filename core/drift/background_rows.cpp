// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What each cell of a remembered background would tell of a move.
#include <algorithm>
#include <cstdint>

#include "core/drift/background_match.hpp"

namespace calibrd {
namespace {

/// Cells of one square of this side share what correlates: bumps that were no planes, multipath, a cable.
constexpr int kClusterSide = 6;

}  // namespace

int BackgroundMatcher::tile_side() const { return (map_.grid().width - 1) / kTilesPerRow + 1; }

/// The sensor moves by δ (sensor axes), the plane m·p = 1 stands: the depth z = 1/(m·d) along d changes by
/// -z (m·δt) - z² (d×m)·δω.
void BackgroundMatcher::refresh() {
  rows_.clear();
  spurious_.setZero();
  const CameraModel& grid = map_.grid();
  const auto per_row = static_cast<std::uint32_t>((grid.width - 1) / kClusterSide + 1);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto cell = static_cast<std::uint32_t>(y * grid.width + x);
      const BackgroundCell& known = map_.cells()[cell];
      if (!known.has_plane()) continue;
      const Eigen::Vector3f d = map_.rays().at(x, y).cast<float>(), m = known.normal_per_m;
      const float z = known.depth_m;
      Row row{cell,
              static_cast<std::uint32_t>(y / kClusterSide) * per_row +
                  static_cast<std::uint32_t>(x / kClusterSide),
              static_cast<std::uint32_t>(y / tile_side() * kTilesPerRow + x / tile_side()), known.sigma_m};
      row.slope.head<3>() = -z * z * d.cross(m);
      row.slope.segment<3>(3) = -z * m;
      row.slope[6] = 1;
      rows_.push_back(row);
      add_spurious(known, d);
    }
  }
  std::ranges::stable_sort(rows_, {}, &Row::tile);
  tiles_ = static_cast<std::size_t>(kTilesPerRow * ((grid.height - 1) / tile_side() + 1));
  clusters_ =
      static_cast<std::size_t>(per_row) * static_cast<std::size_t>((grid.height - 1) / kClusterSide + 1);
}

/// Normals that scatter look as if they showed every direction: a plain wall would seem to tell of moves
/// along it. How much of the squares of the slopes is but that.
void BackgroundMatcher::add_spurious(const BackgroundCell& known, const Eigen::Vector3f& ray) {
  const double z = known.depth_m, sigma = known.sigma_m;
  const Eigen::Vector3d d = ray.cast<double>();
  Eigen::Matrix<double, 6, 3> slope_by_normal;
  slope_by_normal.topRows<3>() << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;
  slope_by_normal.topRows<3>() *= z * z;
  slope_by_normal.bottomRows<3>() = -z * Eigen::Matrix3d::Identity();
  spurious_.topLeftCorner<6, 6>() +=
      slope_by_normal * known.normal_noise.cast<double>() * slope_by_normal.transpose() / (sigma * sigma);
}

}  // namespace calibrd
