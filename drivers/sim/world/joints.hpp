// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace calibrd::sim {

inline constexpr int kMaxJoints = 16;

/// Joint values, rad or m; entries past the robot's joint count are 0.
using Joints = std::array<double, kMaxJoints>;

}  // namespace calibrd::sim
