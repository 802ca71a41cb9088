// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.hpp"
#include "drivers/robot/simple_message/message.hpp"

namespace calibrd::simple_message {

/// Beyond these no axis can be: such a value is damage, not data.
struct ValueLimits {
  double max_position = 100;  ///< rad, or m for a linear axis
  double max_velocity = 100;  ///< rad/s, or m/s
};

/// Every real that the sender marks as valid is finite, positions and velocities are within `limits`.
/// Errors: value_not_finite, value_out_of_range, naming the joint.
Status check_values(const Body& body, const ValueLimits& limits);

}  // namespace calibrd::simple_message
