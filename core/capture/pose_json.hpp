// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// T_base_sensor from what a user gives as POSE: the path of a JSON file that holds `T_base_sensor` (4×4, 3×4
/// or 12 row-major numbers, m), or the text `x,y,z,qx,qy,qz,qw` (m, quaternion of any length but zero, w
/// last). A matrix must hold a rotation to within 1e-3; it is made exactly orthonormal. A translation beyond
/// 100 m is refused: it is in millimetres. Errors: CaptureError::bad_pose_file; unreadable, file_too_large
/// for a file.
Result<Pose> read_pose(const std::string& file_or_text);

/// T_base_sensor from JSON text that holds it.
Result<Pose> parse_pose_json(std::string_view json_text, const std::string& name);

}  // namespace calibrd
