// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "drivers/sim/world/mesh.hpp"

namespace calibrd::sim {

struct RobotLink {
  std::string name;
  int parent_joint = -1;  ///< index into Robot::joints; -1 for the root
  Mesh mesh;              ///< link frame
  Surface surface;
};

enum class Movement { fixed, turning, sliding };

struct RobotJoint {
  std::string name;
  Movement movement = Movement::fixed;
  int parent_link = -1;
  int child_link = -1;
  Eigen::Isometry3d T_parent_joint = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector, joint frame
  int position = -1;      ///< index into the position vector that drives it; -1 for a fixed joint
  double multiplier = 1;  ///< with `offset`: value = multiplier * position + offset (mimic joints)
  double offset = 0;
};

struct PositionRange {
  std::string name;
  double lower = 0, upper = 0;  ///< rad or m
};

/// The simulated robot, with kinematics of its own: nothing here is shared with core's robot model, so that
/// neither can hide the other's mistake.
struct Robot {
  std::string name;
  int base_link = 0;                     ///< frame that poses are given in
  std::vector<RobotLink> links;          ///< parents before children
  std::vector<RobotJoint> joints;        ///< parents before children
  std::vector<PositionRange> positions;  ///< one per value of a position vector, in its order

  /// T_base_link of every link. `values`: at least positions.size() numbers, rad or m.
  std::vector<Eigen::Isometry3d> link_poses(std::span<const double> values) const;
};

}  // namespace calibrd::sim
