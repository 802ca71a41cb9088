// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/commanded_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "drivers/robot/motion/motion_error.hpp"

namespace calibrd {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kStep_s = 0.02;

std::string in_words(const JointGap& gap) {
  char text[64];
  std::snprintf(text, sizeof text, "joint %zu is %.2f deg off", gap.joint + 1,
                gap.rad * 180 / std::numbers::pi);
  return text;
}

}  // namespace

JointGap widest_gap(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) return {0, std::numeric_limits<double>::infinity()};
  JointGap widest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double gap = std::abs(a[i] - b[i]);
    if (!(gap <= widest.rad)) widest = {i, gap};  // so that NaN counts as a gap
  }
  return widest;
}

double CommandedPath::elapsed_s(Clock::time_point now) const {
  return begun_ ? Seconds(now - *begun_).count() : 0.0;
}

std::optional<Error> CommandedPath::deviation(std::span<const double> positions_rad, Clock::time_point stamp,
                                              const PathTolerance& tolerance) const {
  const double last_s = begun_ ? elapsed_s(stamp) + Seconds(tolerance.lead).count() : 0.0;
  const double first_s = begun_ ? elapsed_s(stamp) - Seconds(tolerance.lag).count() : 0.0;
  JointGap least{0, std::numeric_limits<double>::infinity()};
  for (double t = std::max(0.0, first_s); t <= std::max(0.0, last_s); t += kStep_s) {
    const auto gap = widest_gap(positions_rad, move_.at(t).positions_rad);
    if (gap.rad < least.rad) least = gap;
  }
  if (least.rad <= tolerance.joint_rad) return std::nullopt;
  return Error{MotionError::off_path, in_words(least)};
}

}  // namespace calibrd
