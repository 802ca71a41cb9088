// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/robot.hpp"

namespace calibrd::sim {
namespace {

/// Rodrigues' formula, written out.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& k, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad), v = 1 - c;
  Eigen::Matrix3d r;
  r << c + k.x() * k.x() * v, k.x() * k.y() * v - k.z() * s, k.x() * k.z() * v + k.y() * s,
      k.y() * k.x() * v + k.z() * s, c + k.y() * k.y() * v, k.y() * k.z() * v - k.x() * s,
      k.z() * k.x() * v - k.y() * s, k.z() * k.y() * v + k.x() * s, c + k.z() * k.z() * v;
  return r;
}

Eigen::Isometry3d joint_motion(const RobotJoint& joint, std::span<const double> values) {
  Eigen::Isometry3d T_joint_child = Eigen::Isometry3d::Identity();
  if (joint.movement == Movement::fixed) return T_joint_child;
  const double value = joint.multiplier * values[static_cast<std::size_t>(joint.position)] + joint.offset;
  if (joint.movement == Movement::turning)
    T_joint_child.linear() = rotation_about(joint.axis, value);
  else
    T_joint_child.translation() = value * joint.axis;
  return T_joint_child;
}

}  // namespace

std::vector<Eigen::Isometry3d> Robot::link_poses(std::span<const double> values) const {
  std::vector<Eigen::Isometry3d> T_root_link(links.size(), Eigen::Isometry3d::Identity());
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].parent_joint < 0) continue;
    const RobotJoint& joint = joints[static_cast<std::size_t>(links[i].parent_joint)];
    T_root_link[i] = T_root_link[static_cast<std::size_t>(joint.parent_link)] * joint.T_parent_joint *
                     joint_motion(joint, values);
  }
  if (base_link == 0) return T_root_link;
  const Eigen::Isometry3d T_base_root = T_root_link[static_cast<std::size_t>(base_link)].inverse();
  for (auto& pose : T_root_link) pose = T_base_root * pose;
  return T_root_link;
}

}  // namespace calibrd::sim
