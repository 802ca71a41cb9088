// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/robot_model_error.hpp"

#include <string>

namespace calibrd {
namespace {

const char* text(RobotModelError code) {
  switch (code) {
    case RobotModelError::urdf_not_found:
      return "the URDF cannot be read; check the path and its permissions (from xacro: `xacro robot.xacro > "
             "robot.urdf`)";
    case RobotModelError::urdf_invalid:
      return "not a valid URDF; correct what is named (check_urdf of urdfdom-tools shows the same)";
    case RobotModelError::not_a_tree:
      return "the links do not form one tree; give every link but the root exactly one parent joint";
    case RobotModelError::unknown_link:
      return "the URDF has no such link; use one of its link names";
    case RobotModelError::unsupported_joint:
      return "joint type not supported; use revolute, continuous, prismatic or fixed (for a robot on a "
             "track, one prismatic joint)";
    case RobotModelError::bad_axis:
      return "the joint axis has no direction; give <axis xyz=\"…\"/> a vector other than zero";
    case RobotModelError::bad_number:
      return "not a finite number, or beyond a million; correct the value in the URDF";
    case RobotModelError::bad_mimic:
      return "the <mimic> cannot be followed; let it name, directly or through others, a joint that moves by "
             "itself";
    case RobotModelError::bad_geometry:
      return "not a solid size; give sizes in metres, greater than zero, and a mesh scale without zeros";
    case RobotModelError::mesh_not_found:
      return "mesh file not found; correct the path, or add the folder that holds it (for package://NAME/…: "
             "the folder "
             "that holds NAME) to the model search paths";
    case RobotModelError::mesh_unreadable:
      return "mesh file cannot be used; export it again as STL, Collada (.dae) or OBJ";
    case RobotModelError::link_moves:
      return "the link moves with the robot; use one that stands still, which the URDF joins to the base by "
             "fixed joints alone";
  }
  return "unknown robot model error";
}

class RobotModelCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "robot_model"; }
  std::string message(int code) const override { return text(static_cast<RobotModelError>(code)); }
};

}  // namespace

const std::error_category& robot_model_category() {
  static const RobotModelCategory category;
  return category;
}

std::error_code make_error_code(RobotModelError code) {
  return {static_cast<int>(code), robot_model_category()};
}

}  // namespace calibrd
