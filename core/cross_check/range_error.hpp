// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>

namespace calibrd {

/// What a calibration leaves of a sensor's range error: any smooth function of depth, piecewise linear
/// between knots. The robot shows it only at the robot's depths; walls lie beyond.
class RangeError {
 public:
  /// For depths from `least_m` to `most_m`; `known_at_m`: where the robot is, by which it was calibrated.
  RangeError(double least_m, double most_m, double known_at_m);

  Eigen::Index knots() const { return knots_; }
  /// The error at a depth is (1 - share) of knot `index` and `share` of the next.
  struct Place {
    Eigen::Index index;
    double share;
  };
  Place at(double depth_m) const;
  /// Inverse of the knots' covariance before anything is seen, 1/m².
  Eigen::MatrixXd precision() const;

 private:
  double least_m_, known_at_m_, step_m_;
  Eigen::Index knots_;
};

}  // namespace calibrd
