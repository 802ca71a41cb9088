// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd {

/// Why the paper's method gives no pose, or what is wrong with its options.
enum class PaperError { robot_not_found = 1, pcl_missing, pcl_failed, bad_region, other_method };

const std::error_category& paper_error_category();

inline std::error_code make_error_code(PaperError error) {
  return {static_cast<int>(error), paper_error_category()};
}

inline Error fail(PaperError error, std::string detail = "") {
  return {make_error_code(error), std::move(detail)};
}

/// The stable name of an error of this module, for programs.
std::string paper_error_name(const Error& error);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::PaperError> : std::true_type {};
