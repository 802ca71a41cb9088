// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

namespace calibrd {

/// Highest speed and acceleration of any joint, rad/s and rad/s^2.
struct JointMoveLimits {
  double max_speed_rad_s = 0;
  double max_acceleration_rad_s2 = 0;
};

/// Where the joints are to be at a time of a move.
struct TrajectoryPoint {
  double time_s = 0;
  std::vector<double> positions_rad, velocities_rad_s, accelerations_rad_s2;
};

/// A move straight in joint space, all joints together, from rest to rest, with the profile of least jerk
/// (quintic; Flash and Hogan 1985). It is so long that no joint exceeds the limits, also not where the
/// controller interpolates between points() as MotoROS does (cubic, from their positions and speeds).
class JointMove {
 public:
  static constexpr double kPointInterval_s = 0.1;

  /// `from` and `to` have the same size; the limits are greater than zero.
  JointMove(std::vector<double> from_rad, std::vector<double> to_rad, const JointMoveLimits& limits);

  double duration_s() const { return kPointInterval_s * intervals_; }
  const std::vector<double>& goal_rad() const { return to_; }

  /// Before the start and after the end: at rest there.
  TrajectoryPoint at(double time_s) const;

  /// What is sent: the start, and a point each kPointInterval_s up to the end.
  int point_count() const { return intervals_ + 1; }
  TrajectoryPoint point(int index) const { return at(kPointInterval_s * index); }

 private:
  std::vector<double> from_, to_;
  int intervals_;
};

}  // namespace calibrd
