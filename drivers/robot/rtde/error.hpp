// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd::rtde {

enum class RtdeError {
  // After one of these the connection must be closed.
  size_out_of_range = 1,
  unexpected_package,
  wrong_payload_size,
  protocol_refused,
  variable_not_found,
  variable_of_other_type,
  start_refused,
  unknown_recipe,
  clock_ran_back,
  // Nothing is wrong so far, or the package is well formed and its joints are not usable: read on.
  handshake_unfinished,
  clock_stands_still,
  arm_without_power,
  value_not_finite,
  value_out_of_range,
};

std::error_code make_error_code(RtdeError error);

}  // namespace calibrd::rtde

template <>
struct std::is_error_code_enum<calibrd::rtde::RtdeError> : std::true_type {};
