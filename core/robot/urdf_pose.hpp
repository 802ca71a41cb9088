// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/geometry/pose.hpp"

namespace urdf {
class Pose;
class Vector3;
}  // namespace urdf

namespace calibrd {

Eigen::Vector3d to_eigen(const urdf::Vector3& vector);

/// Finite numbers, none beyond a million (m, or a ratio): what is larger is damage, and overflows further on.
template <class Numbers>
bool are_usable(const Numbers& numbers) {
  return (numbers.array().abs() <= 1e6).all();  // NaN compares false
}

/// urdfdom keeps the rotation as a quaternion in double; this loses nothing.
Pose to_pose(const urdf::Pose& origin);

}  // namespace calibrd
