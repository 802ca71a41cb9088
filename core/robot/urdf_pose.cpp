// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/urdf_pose.hpp"

#include <urdf_model/pose.h>

namespace calibrd {

Eigen::Vector3d to_eigen(const urdf::Vector3& vector) { return {vector.x, vector.y, vector.z}; }

Pose to_pose(const urdf::Pose& origin) {
  const auto& [x, y, z, w] = origin.rotation;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  pose.translation() = to_eigen(origin.position);
  return pose;
}

}  // namespace calibrd
