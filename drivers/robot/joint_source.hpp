// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/sensing/images.hpp"

namespace calibrd {

/// A controller's state word. Unset = the controller says it does not know.
struct ControllerStatus {
  std::optional<bool> drives_powered, e_stopped, in_error, in_motion, motion_possible;
  enum class Mode { unknown, manual, automatic } mode = Mode::unknown;
  int error_code = 0;
  Clock::time_point stamp;  ///< monotonic time of reception
};

/// Joint positions as they come off the wire, before the joint mapping: controller order and units (rad).
struct ControllerJoints {
  int group = 0;
  std::vector<double> positions_rad;
  std::vector<double> velocities_rad;  ///< per second; empty when not sent
  std::uint64_t sequence = 0;  ///< counts joint messages since start; a gap: older ones came in the same read
  Clock::time_point stamp;     ///< monotonic time of reception of the message's first byte
  /// The controller's own clock (s since its start) when the joints were there; unset where it sends none.
  std::optional<double> controller_time_s = {};
};

/// How a robot link is doing, in words a person can act on. What each state means: docs/controllers.md.
struct RobotLinkHealth {
  enum class State {
    connecting,    ///< no connection
    streaming,     ///< joints are fresh
    joints_stale,  ///< messages arrive, fresh joints do not
    silent,        ///< connected, nothing arrives
    faulted  ///< somebody must act: what arrives cannot be read, or the controller throws this client out
  };
  State state = State::connecting;
  std::string reason;         ///< why it is not streaming, and what to do; empty while it is
  bool status_fresh = false;  ///< false: what on_status said last no longer counts
  // Since start:
  std::uint64_t connects = 0;
  std::uint64_t messages = 0;  ///< well-formed ones of any kind
  std::uint64_t framing_errors = 0;
  std::uint64_t rejected_values = 0;   ///< messages dropped for NaN, infinities or absurd positions
  std::uint64_t other_group = 0;       ///< joint messages of groups that are not configured
  std::uint64_t skipped_messages = 0;  ///< well-formed messages of other kinds
};

/// What a robot link tells its owner. Called on the link's executor, one call at a time; none after stop().
/// An unset function is not called.
struct RobotLinkEvents {
  std::function<void(const ControllerJoints&)> on_joints;
  std::function<void(const ControllerStatus&)> on_status;
  /// On every change of state, reason or status_fresh.
  std::function<void(const RobotLinkHealth&)> on_health;
};

}  // namespace calibrd
