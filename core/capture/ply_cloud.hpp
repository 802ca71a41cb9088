// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// What can be wrong with a PLY file, beside what read_bytes() says of any file.
enum class PlyError {
  not_ply = 1,
  bad_header,
  not_binary_little_endian,
  no_vertices,
  wrong_properties,
  truncated
};

const std::error_category& ply_error_category();

inline std::error_code make_error_code(PlyError error) {
  return {static_cast<int>(error), ply_error_category()};
}

/// The points (m) of a binary little-endian PLY file: element `vertex` comes first and has float x, y and z;
/// its other properties, lists excepted, and further elements are left aside.
/// Errors: PlyError, CaptureError::unreadable, file_too_large.
Result<std::vector<Eigen::Vector3f>> read_ply(const std::filesystem::path& path);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::PlyError> : std::true_type {};
