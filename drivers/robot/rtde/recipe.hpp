// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd::rtde {

constexpr std::size_t kJointCount = 6;

/// A variable of the controller that calibrd knows to read.
enum class Variable {
  timestamp,           ///< s since the controller was started
  actual_q,            ///< joint positions, rad, base to wrist 3
  actual_qd,           ///< rad/s
  robot_mode,          ///< see RobotMode
  safety_status_bits,  ///< see SafetyBit
};

/// What calibrd asks for. All of it is known to every controller that speaks RTDE.
inline constexpr std::array kAllVariables{Variable::timestamp, Variable::actual_q, Variable::actual_qd,
                                          Variable::robot_mode, Variable::safety_status_bits};

std::string_view name_of(Variable variable);

/// Of the values a controller reports; others exist.
enum class RobotMode : std::int32_t { power_off = 3, power_on = 4, idle = 5, backdrive = 6, running = 7 };

enum class SafetyBit : std::uint32_t {
  normal = 0,
  reduced = 1,
  protective_stop = 2,
  system_emergency_stop = 5,
  robot_emergency_stop = 6,
  emergency_stop = 7,
  violation = 8,
  fault = 9,
};

/// One data package.
struct RobotState {
  double timestamp_s = 0;
  std::array<double, kJointCount> positions_rad{}, velocities_rad_s{};
  std::int32_t mode = 0;
  std::uint32_t safety_bits = 0;

  bool is(RobotMode wanted) const { return mode == static_cast<std::int32_t>(wanted); }
  bool is(SafetyBit bit) const { return (safety_bits >> static_cast<std::uint32_t>(bit) & 1U) != 0; }
};

/// The controller's answer to the question for these variables: one type each, the one expected.
/// Errors: variable_not_found naming all that are missing, variable_of_other_type.
Status check_types(std::span<const Variable> recipe, const std::vector<std::string>& types);

/// The payload of a data package without the id of the recipe. What the recipe lacks stays 0.
/// Error: wrong_payload_size.
Result<RobotState> read_state(std::span<const Variable> recipe, std::span<const std::byte> payload);

}  // namespace calibrd::rtde
