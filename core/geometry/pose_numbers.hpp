// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <system_error>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// Why a list of numbers is no pose.
enum class PoseNumbersError {
  wrong_count = 1,
  not_finite,
  not_a_rotation,
  no_direction,
  bad_last_row,
  too_far
};

const std::error_category& pose_numbers_category();
std::error_code make_error_code(PoseNumbersError code);

/// The pose of 7 numbers (x, y, z, qx, qy, qz, qw), 12 (3x4 row-major) or 16 (4x4 row-major). Metres: a
/// translation beyond 100 m is in millimetres and is refused. A quaternion may have any length but zero; a
/// matrix within 1e-3 of a rotation is made exact. The one place where poses from outside are judged.
/// Errors: PoseNumbersError.
Result<Pose> pose_of_numbers(std::span<const double> numbers);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::PoseNumbersError> : std::true_type {};
