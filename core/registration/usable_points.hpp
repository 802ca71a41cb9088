// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace calibrd {

/// Where the usable points of a cloud lie: those that are finite and within 100 km.
struct UsableExtent {
  Eigen::AlignedBox3f box;  ///< empty when there is none
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
};
UsableExtent usable_extent(std::span<const Eigen::Vector3f> points);

/// The usable points within `bounds`, as seen from `origin`, so that floats keep their digits. Evenly thinned
/// to `max_points` when there are more.
std::vector<Eigen::Vector3f> usable_points(std::span<const Eigen::Vector3f> points,
                                           const Eigen::AlignedBox3f& bounds, const Eigen::Vector3f& origin,
                                           std::size_t max_points);

}  // namespace calibrd
