// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <system_error>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd::api {

/// Why a list of numbers is no pose.
enum class PoseNumbersError {
  wrong_count = 1,
  not_finite,
  not_a_rotation,
  not_a_unit_quaternion,
  bad_last_row
};

const std::error_category& pose_numbers_category();
std::error_code make_error_code(PoseNumbersError code);

/// The pose of 7 numbers (x, y, z, qx, qy, qz, qw), 12 (3x4 row-major) or 16 (4x4 row-major). Metres.
/// Rotations within 1e-3 of orthonormal are taken and made exact. Errors: PoseNumbersError.
Result<Pose> pose_of_numbers(std::span<const double> numbers);

}  // namespace calibrd::api

template <>
struct std::is_error_code_enum<calibrd::api::PoseNumbersError> : std::true_type {};
