// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd {

/// Why two clouds could not be registered.
enum class CloudRegistrationError { too_few_points = 1, no_overlap, unobservable };

const std::error_category& cloud_registration_error_category();

inline std::error_code make_error_code(CloudRegistrationError error) {
  return {static_cast<int>(error), cloud_registration_error_category()};
}

inline Error fail(CloudRegistrationError error, std::string detail) {
  return {make_error_code(error), std::move(detail)};
}

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::CloudRegistrationError> : std::true_type {};
