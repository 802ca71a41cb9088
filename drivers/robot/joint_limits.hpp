// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// Where one joint can be, rad or m. Give the model's limits plus a margin.
struct JointRange {
  double lower = 0, upper = 0;
};

/// The first position that is outside its range, joints counted from 1: RobotLinkError::outside_joint_range.
/// There may be fewer ranges than joints.
std::optional<Error> outside_ranges(std::span<const double> positions, std::span<const JointRange> ranges);

}  // namespace calibrd
