// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why a robot link cannot be configured, does not connect, was lost, or delivers no joints.
enum class RobotLinkError {
  // Configuration
  host_missing = 1,
  driver_unknown,
  port_out_of_range,
  port_commands_the_robot,
  group_out_of_range,
  joint_count_out_of_range,
  real_bytes_invalid,
  limit_invalid,
  joint_range_invalid,
  interval_invalid,
  // Connecting
  connecting,
  host_unknown,
  refused,
  unreachable,
  no_answer,
  connect_failed,
  stopped,
  // A connection lost
  closed_by_controller,
  connection_failed,
  evicted,
  silent,
  held_up,
  out_of_resources,
  // Connected, but without joints
  joints_missing,
  only_other_groups,
  no_positions,
  outside_joint_range,
};

std::error_code make_error_code(RobotLinkError error);

/// Translates what the operating system says about a connection attempt; a RobotLinkError stays as it is.
std::error_code explain_connect_failure(const std::error_code& foreign);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::RobotLinkError> : std::true_type {};
