// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/joint_limits.hpp"

#include <algorithm>
#include <string>

#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {

std::optional<Error> outside_ranges(std::span<const double> positions, std::span<const JointRange> ranges) {
  for (std::size_t i = 0; i < std::min(positions.size(), ranges.size()); ++i) {
    const JointRange& range = ranges[i];
    if (positions[i] >= range.lower && positions[i] <= range.upper) continue;
    return Error{RobotLinkError::outside_joint_range,
                 "joint " + std::to_string(i + 1) + " at " + std::to_string(positions[i]) + ", allowed " +
                     std::to_string(range.lower) + " to " + std::to_string(range.upper)};
  }
  return std::nullopt;
}

}  // namespace calibrd
