// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/usable_points.hpp"

namespace calibrd {
namespace {

bool is_usable(const Eigen::Vector3f& p) {
  constexpr float kFarthest_m = 1e5F;            // beyond it lies no measurement, only an overflow waiting
  return (p.array().abs() < kFarthest_m).all();  // not of NaN either
}

}  // namespace

UsableExtent usable_extent(std::span<const Eigen::Vector3f> points) {
  UsableExtent extent;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (const Eigen::Vector3f& p : points) {
    if (!is_usable(p)) continue;
    extent.box.extend(p);
    sum += p.cast<double>();
    ++count;
  }
  if (count > 0) extent.centroid = (sum / static_cast<double>(count)).cast<float>();
  return extent;
}

std::vector<Eigen::Vector3f> usable_points(std::span<const Eigen::Vector3f> points,
                                           const Eigen::AlignedBox3f& bounds, const Eigen::Vector3f& origin,
                                           std::size_t max_points) {
  std::vector<Eigen::Vector3f> kept;
  kept.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
    if (is_usable(p) && bounds.contains(p)) kept.push_back(p - origin);
  if (kept.size() <= max_points) return kept;
  const double step = static_cast<double>(kept.size()) / static_cast<double>(max_points);
  for (std::size_t i = 0; i < max_points; ++i)
    kept[i] = kept[static_cast<std::size_t>(step * static_cast<double>(i))];
  kept.resize(max_points);
  return kept;
}

}  // namespace calibrd
