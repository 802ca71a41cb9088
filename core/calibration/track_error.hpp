// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd {

/// Why a frame says nothing about the pose.
enum class TrackError { wrong_image_size = 1, wrong_joints, too_few_pixels, unobservable };

const std::error_category& track_error_category();

inline std::error_code make_error_code(TrackError error) {
  return {static_cast<int>(error), track_error_category()};
}

inline Error fail(TrackError error, std::string detail) {
  return {make_error_code(error), std::move(detail)};
}

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::TrackError> : std::true_type {};
