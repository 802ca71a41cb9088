// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/drift/stands_within.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

struct ShiftTestSettings {
  double tolerance_m = kStandsWithin, tolerance_rad = kStandsWithin;
  double false_alarms_per_year = 0.1;  ///< of one sensor that stands, at `rate_hz`
  double rate_hz = 30;
};

/// Tells from a series of noisy shifts whether a sensor has moved: a one-sided CUSUM (Page 1954) of the shift
/// along the direction that the frames before point to, less the farthest that the tolerance reaches that
/// way, in standard deviations. While the sensor stands its increments have mean <= 0 whatever the shift
/// within the tolerance, and the direction does not know the frame it is used on. The limit follows from the
/// false alarms allowed (Siegmund 1985). What all frames are off by together is tolerated, too, up to three
/// of its standard deviations: a sum over frames does not average it out. Without I/O; not thread-safe.
class ShiftTest {
 public:
  explicit ShiftTest(const ShiftTestSettings& settings);

  /// `turn_shift`: rotation (rad), and shift (m) of a point amid what is seen; `covariance` of it, of which
  /// `common_share` is the same in all frames: the noise of what they are compared with.
  void add(const Vector6d& turn_shift, const Matrix6d& covariance, double common_share = 0);
  void reset();

  /// Of what all frames have in common, as much is tolerated.
  static constexpr double kCommonSigmas = 3;

  bool is_alarmed() const { return statistic_ > threshold_; }
  double statistic() const { return statistic_; }
  double threshold() const { return threshold_; }
  /// Frames since the statistic was last 0.
  int run_length() const { return run_length_; }
  /// Mean of the last frames: turn (rad) and shift (m) as given to add().
  Vector6d mean() const;

 private:
  ShiftTestSettings settings_;
  double threshold_;
  double statistic_ = 0;
  int run_length_ = 0, frames_ = 0;
  Vector6d scaled_mean_ = Vector6d::Zero();  // in tolerances
};

/// Threshold of a CUSUM of unit normal increments with the given allowance, so that it alarms once in
/// `run_length` samples on average while nothing has changed (Siegmund's approximation).
double cusum_threshold(double allowance, double run_length);

}  // namespace calibrd
