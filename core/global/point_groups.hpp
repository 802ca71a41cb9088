// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace calibrd {

/// Points that hang together: a robot's arm, or a person who walks past.
struct PointGroup {
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  std::size_t size = 0;
  void add(const Eigen::Vector3f& point);  ///< while `middle` is still a sum
};

/// Groups of points of which each lies within `reach_m` of another, the largest first, without those of fewer
/// than `min_size`.
std::vector<PointGroup> group_points(std::span<const Eigen::Vector3f> points, float reach_m,
                                     std::size_t min_size);

/// Points that share a cube of side `side_m`, likewise: parts of a scene in which all hangs together.
std::vector<PointGroup> group_by_cubes(std::span<const Eigen::Vector3f> points, float side_m,
                                       std::size_t min_size);

}  // namespace calibrd
