// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

namespace calibrd {

/// Whether a robot that stands as `a` and as `b` (rad) stands in one posture: what its model and its joint
/// zeros make of the two is the same.
inline bool is_same_posture(std::span<const double> a, std::span<const double> b) {
  constexpr double kOther_rad = 0.05;
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) < kOther_rad; });
}

}  // namespace calibrd
