// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/point_groups.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace calibrd {

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
  for (std::size_t i = 0; i < points.size(); ++i) {
    PointGroup& group = by_leader[find(i)];
    group.middle += points[i];
    ++group.size;
  }
  std::vector<PointGroup> groups;
  for (PointGroup& group : by_leader) {
    if (group.size == 0 || group.size < min_size) continue;
    group.middle /= static_cast<float>(group.size);
    groups.push_back(group);
  }
  std::ranges::stable_sort(groups, std::greater<>{}, &PointGroup::size);
  return groups;
}

}  // namespace calibrd
