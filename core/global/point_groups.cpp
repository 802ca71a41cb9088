// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/point_groups.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>

namespace calibrd {
namespace {

/// From sums of points to their means, the largest first.
std::vector<PointGroup> large_ones(std::vector<PointGroup> sums, std::size_t min_size) {
  std::vector<PointGroup> groups;
  for (PointGroup& group : sums) {
    if (group.size == 0 || group.size < min_size) continue;
    group.middle /= static_cast<float>(group.size);
    groups.push_back(group);
  }
  std::ranges::stable_sort(groups, std::greater<>{}, &PointGroup::size);
  return groups;
}

}  // namespace

void PointGroup::add(const Eigen::Vector3f& point) {
  middle += point;
  ++size;
}

std::vector<PointGroup> group_points(std::span<const Eigen::Vector3f> points, float reach_m,
                                     std::size_t min_size) {
  std::vector<std::size_t> leader(points.size());
  std::iota(leader.begin(), leader.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  const float squared_reach = reach_m * reach_m;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((points[i] - points[j]).squaredNorm() < squared_reach) leader[find(i)] = find(j);

  std::vector<PointGroup> by_leader(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) by_leader[find(i)].add(points[i]);
  return large_ones(std::move(by_leader), min_size);
}

std::vector<PointGroup> group_by_cubes(std::span<const Eigen::Vector3f> points, float side_m,
                                       std::size_t min_size) {
  std::map<std::array<int, 3>, PointGroup> cubes;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Array3i cube = (p / side_m).array().floor().cast<int>();
    cubes[{cube.x(), cube.y(), cube.z()}].add(p);
  }
  std::vector<PointGroup> groups;
  for (const auto& [cube, group] : cubes) groups.push_back(group);
  return large_ones(std::move(groups), min_size);
}

}  // namespace calibrd
