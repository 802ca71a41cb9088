// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/joint_move.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

// Of the quintic s(u) = 10 u^3 - 15 u^4 + 6 u^5: highest speed and acceleration in units of way and duration.
const double kPeakSpeed = 1.875;
const double kPeakAcceleration = 10 / std::sqrt(3.0);

// The controller's cubic between two points overshoots the quintic's acceleration by 30 / 5.77 (interval /
// duration)^2: 1.3 % with twenty intervals, less with more. The margin covers it.
constexpr int kFewestIntervals = 20;
constexpr double kMargin = 0.97;

double longest_way(const std::vector<double>& from, const std::vector<double>& to) {
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
  return longest;
}

int intervals_for(double way_rad, const JointMoveLimits& limits) {
  const double by_speed_s = kPeakSpeed * way_rad / (kMargin * limits.max_speed_rad_s);
  const double by_acceleration_s =
      std::sqrt(kPeakAcceleration * way_rad / (kMargin * limits.max_acceleration_rad_s2));
  const double intervals = std::ceil(std::max(by_speed_s, by_acceleration_s) / JointMove::kPointInterval_s);
  return std::max(kFewestIntervals, static_cast<int>(intervals));
}

}  // namespace

JointMove::JointMove(std::vector<double> from_rad, std::vector<double> to_rad, const JointMoveLimits& limits)
    : from_(std::move(from_rad)),
      to_(std::move(to_rad)),
      intervals_(intervals_for(longest_way(from_, to_), limits)) {}

TrajectoryPoint JointMove::at(double time_s) const {
  const double duration = duration_s();
  const double u = std::clamp(time_s / duration, 0.0, 1.0);
  const double s = u * u * u * (10 + u * (-15 + 6 * u));
  const double speed = 30 * u * u * (1 + u * (-2 + u)) / duration;
  const double acceleration = 60 * u * (1 + u * (-3 + 2 * u)) / (duration * duration);
  TrajectoryPoint point{time_s, {}, {}, {}};
  for (std::size_t i = 0; i < from_.size(); ++i) {
    const double way = to_[i] - from_[i];
    point.positions_rad.push_back(u < 1 ? from_[i] + s * way : to_[i]);
    point.velocities_rad_s.push_back(speed * way);
    point.accelerations_rad_s2.push_back(acceleration * way);
  }
  return point;
}

}  // namespace calibrd
