// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/joint_axes.hpp"

namespace calibrd {

JointAxes::JointAxes(const RobotModel& robot, const std::vector<Pose>& T_base_link)
    : carriers_(robot.links().size()) {
  std::vector<int> axis_of(robot.joints().size(), -1);
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    const Joint& joint = robot.joints()[j];
    const JointDrive& drive = robot.drives()[j];
    if (drive.position_index < 0 || drive.position_index >= kMaxJointZeros) continue;
    const Pose T_base_joint = T_base_link[static_cast<std::size_t>(joint.parent_link)] * joint.T_parent_joint;
    axis_of[j] = static_cast<int>(axes_.size());
    axes_.push_back({T_base_joint.translation(), T_base_joint.linear() * joint.axis,
                     joint.type == JointType::prismatic, drive.position_index, drive.multiplier});
  }
  for (std::size_t link = 0; link < robot.links().size(); ++link) {
    for (int j = robot.links()[link].parent_joint; j >= 0;) {
      const auto joint = static_cast<std::size_t>(j);
      if (axis_of[joint] >= 0) carriers_[link].push_back(axis_of[joint]);
      j = robot.links()[static_cast<std::size_t>(robot.joints()[joint].parent_link)].parent_joint;
    }
  }
}

PointByJoints JointAxes::derivative(int link, const Eigen::Vector3d& p_base) const {
  PointByJoints result = PointByJoints::Zero();
  for (const int index : carriers_[static_cast<std::size_t>(link)]) {
    const Axis& axis = axes_[static_cast<std::size_t>(index)];
    const Eigen::Vector3d motion =
        axis.prismatic ? axis.direction_base : axis.direction_base.cross(p_base - axis.origin_base);
    result.col(axis.position) += axis.multiplier * motion;
  }
  return result;
}

JointZeros JointAxes::motion_along(int link, const Eigen::Vector3d& p_base,
                                   const Eigen::Vector3d& direction_base) const {
  JointZeros result = JointZeros::Zero();
  const Eigen::Vector3d moment = p_base.cross(direction_base);
  for (const int index : carriers_[static_cast<std::size_t>(link)]) {
    const Axis& axis = axes_[static_cast<std::size_t>(index)];
    // direction·(axis × (p - origin)) = axis·(p × direction) - (axis × origin)·direction
    const double motion = axis.prismatic
                              ? axis.direction_base.dot(direction_base)
                              : axis.direction_base.dot(moment) -
                                    axis.direction_base.cross(axis.origin_base).dot(direction_base);
    result[axis.position] += axis.multiplier * motion;
  }
  return result;
}

}  // namespace calibrd
