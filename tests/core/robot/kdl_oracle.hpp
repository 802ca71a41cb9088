// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <kdl/tree.hpp>
#include <map>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace calibrd::test {

/// Forward kinematics by orocos-kdl from a reading of the URDF's text that shares no code with RobotModel.
class KdlOracle {
 public:
  explicit KdlOracle(const std::filesystem::path& urdf);

  /// T_root_link of every link for these joint positions (by name; joints left out are at 0).
  std::map<std::string, Pose> link_poses(const std::map<std::string, double>& positions) const;

 private:
  std::string root_;
  KDL::Tree tree_;
};

}  // namespace calibrd::test
