// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
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
  std::uint64_t sequence = 0;          ///< counts joint messages since start
  Clock::time_point stamp;             ///< monotonic time of reception
};

/// How a robot link is doing, in words a person can act on.
struct RobotLinkHealth {
  enum class State { connecting, streaming, joints_stale, silent, faulted };
  State state = State::connecting;
  std::string reason;             ///< why it is not streaming, and what to do; empty while it is
  std::uint64_t connects = 0;
  std::uint64_t framing_errors = 0;
  std::uint64_t rejected_values = 0;  ///< messages dropped for NaN, infinities or absurd positions
};

/// What a robot link tells its owner. Called on the link's executor.
struct RobotLinkEvents {
  std::function<void(const ControllerJoints&)> on_joints;
  std::function<void(const ControllerStatus&)> on_status;
  std::function<void(const RobotLinkHealth&)> on_health;  ///< on every change of state
};

}  // namespace calibrd
