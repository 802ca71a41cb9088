// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

namespace calibrd {

/// Distance to a set of points, on a grid. Immutable once made: safe to read from any thread.
class DistanceField {
 public:
  struct Value {
    float distance_m = 0;
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();  ///< of the distance by the place asked about
  };

  /// The grid reaches `margin_m` beyond the points. Euclidean distance transform of Felzenszwalb and
  /// Huttenlocher (2012). Needs at least one point.
  DistanceField(std::span<const Eigen::Vector3f> points, float voxel_m, float margin_m);

  /// Interpolated between the grid's nodes; outside of the grid, the way to the grid is added.
  Value at(const Eigen::Vector3f& p) const;

 private:
  void mark(std::span<const Eigen::Vector3f> points);
  void transform_along(int axis);

  Eigen::AlignedBox3f box_;  // of the nodes
  float voxel_m_;
  std::array<int, 3> size_{};
  std::vector<float> distance_;  // m, x fastest
};

}  // namespace calibrd
