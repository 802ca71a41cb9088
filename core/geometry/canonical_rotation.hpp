// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>

namespace calibrd {

/// One of the two unit quaternions of a rotation, always the same one: w >= 0, and for a half turn, where w
/// is 0, the first of x, y, z that is not 0 is positive. What is below 1e-12 counts as 0 in that: rounding
/// must not choose.
Eigen::Quaterniond canonical_quaternion(const Eigen::Matrix3d& rotation);

/// Axis times angle, rad, angle in [0, pi]; of a half turn the axis of its canonical quaternion.
Eigen::Vector3d canonical_rotation_vector(const Eigen::Matrix3d& rotation);

}  // namespace calibrd
