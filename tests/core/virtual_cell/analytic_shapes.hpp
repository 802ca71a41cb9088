// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>

namespace calibrd::test {

/// Where a ray meets a shape: `depth` in multiples of the direction, outward normal in the shape's frame.
struct Hit {
  double depth = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// First meeting of a ray with a box centred on the origin (slab method), seen from outside.
inline std::optional<Hit> meet_box(const Eigen::Vector3d& start, const Eigen::Vector3d& direction,
                                   const Eigen::Vector3d& size) {
  double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double side = direction[axis] > 0 ? -0.5 : 0.5;
    const double in = (side * size[axis] - start[axis]) / direction[axis];
    const double out = (-side * size[axis] - start[axis]) / direction[axis];
    if (in > enter) {
      enter = in;
      normal = Eigen::Vector3d::Zero();
      normal[axis] = side > 0 ? 1 : -1;
    }
    leave = std::min(leave, out);
  }
  if (enter >= leave || enter <= 0) return std::nullopt;
  return Hit{enter, normal};
}

/// First meeting of a ray with a sphere about the origin, seen from outside.
inline std::optional<Hit> meet_sphere(const Eigen::Vector3d& start, const Eigen::Vector3d& direction,
                                      double radius) {
  const double a = direction.squaredNorm(), b = start.dot(direction);
  const double root = b * b - a * (start.squaredNorm() - radius * radius);
  if (root <= 0) return std::nullopt;
  const double depth = (-b - std::sqrt(root)) / a;
  if (depth <= 0) return std::nullopt;
  return Hit{depth, (start + depth * direction).normalized()};
}

}  // namespace calibrd::test
