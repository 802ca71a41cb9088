// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd {

/// What can be wrong with a recording.
enum class CaptureError {
  no_such_folder = 1,
  unreadable,
  file_too_large,
  path_outside,
  bad_json,
  wrong_format,
  missing_key,
  bad_value,
  no_frames,
  urdf_not_found,
  bad_png,
  wrong_image_size,
  wrong_bit_depth,
  wrong_joint_count,
  unknown_joint,
  missing_joint,
  duplicate_joint,
  folder_not_empty,
  unwritable,
  bad_pose_file,
};

const std::error_category& capture_error_category();

inline std::error_code make_error_code(CaptureError error) {
  return {static_cast<int>(error), capture_error_category()};
}

inline Error fail(CaptureError error, std::string detail) {
  return {make_error_code(error), std::move(detail)};
}

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::CaptureError> : std::true_type {};
