// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <urdf_model/pose.h>

#include "core/geometry/pose.hpp"

namespace calibrd {

inline Eigen::Vector3d to_eigen(const urdf::Vector3& vector) { return {vector.x, vector.y, vector.z}; }

/// urdfdom keeps the rotation as a quaternion in double; this loses nothing.
inline Pose to_pose(const urdf::Pose& origin) {
  const auto& [x, y, z, w] = origin.rotation;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  pose.translation() = to_eigen(origin.position);
  return pose;
}

}  // namespace calibrd
