// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/robot/robot_model.hpp"

namespace calibrd {

/// Joint zeros are estimated for this many joints, counted from the base; further ones keep what is reported.
constexpr int kMaxJointZeros = 8;
using JointZeros = Eigen::Matrix<double, kMaxJointZeros, 1>;  ///< true minus reported position
using PointByJoints = Eigen::Matrix<double, 3, kMaxJointZeros>;

/// How the joints move what hangs on them, at one posture.
class JointAxes {
 public:
  /// T_base_link: of every link of `robot`, as forward_kinematics() gives them.
  JointAxes(const RobotModel& robot, const std::vector<Pose>& T_base_link);

  /// Derivative (m per rad or m) of a point on `link` (base frame) by the joint positions; zero for joints
  /// that do not carry the link.
  PointByJoints derivative(int link, const Eigen::Vector3d& p_base) const;

  /// derivative()ᵀ direction: how fast the joints move the point along a direction of the base frame.
  JointZeros motion_along(int link, const Eigen::Vector3d& p_base,
                          const Eigen::Vector3d& direction_base) const;

 private:
  struct Axis {
    Eigen::Vector3d origin_base, direction_base;
    bool prismatic;
    int position;       // column of the derivative
    double multiplier;  // of mimic joints
  };
  std::vector<Axis> axes_;
  std::vector<std::vector<int>> carriers_;  // per link: axes from the link to the root
};

}  // namespace calibrd
