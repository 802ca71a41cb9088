// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why a robot model, or a link of it, cannot be used. Error::detail names the file, link or joint.
enum class RobotModelError {
  urdf_not_found = 1,
  urdf_invalid,
  not_a_tree,
  unknown_link,
  unsupported_joint,
  bad_axis,
  bad_number,
  bad_mimic,
  bad_geometry,
  mesh_not_found,
  mesh_unreadable,
  link_moves,
};

const std::error_category& robot_model_category();
std::error_code make_error_code(RobotModelError code);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::RobotModelError> : std::true_type {};
