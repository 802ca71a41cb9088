// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why the robot is not moved, or why a motion was ended before its last posture.
enum class MotionError {
  // Configuration
  port_not_for_motion = 1,
  // Doubts: before a motion each of them refuses it, while it runs each of them stops it.
  link_down,
  joints_stale,
  status_stale,
  not_automatic,
  e_stopped,
  in_error,
  drives_off,
  motion_not_possible,
  // Before the port is opened
  in_motion,
  not_at_rest,
  moved_since_checked,
  // On the motion port
  connect_failed,
  closed_by_controller,
  no_reply,
  reply_unreadable,
  refused_by_controller,
  busy_too_long,
  off_path,
  not_arrived,
  held_up,
  short_of_resources,
  // Stopped by somebody
  stop_requested,
  daemon_ends,
};

std::error_code make_error_code(MotionError error);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::MotionError> : std::true_type {};
