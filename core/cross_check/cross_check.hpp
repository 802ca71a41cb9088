// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "core/drift/background_map.hpp"
#include "core/sensing/depth_correction.hpp"

namespace calibrd {

/// A calibrated sensor and what it sees of the cell where the robot is not.
struct CheckedSensor {
  const BackgroundMap& background;
  Pose T_base_sensor;
  Matrix6d covariance;  ///< see perturbed()
  DepthCorrection correction;
};

/// Whether two sensors see the same things at the same places.
struct CrossCheck {
  bool has_overlap = false;      ///< enough of what the second sees the first sees too
  std::size_t pairs = 0;         ///< cells of the second that lie on a surface the first sees
  std::size_t seen_through = 0;  ///< cells of the second that lie where the first looks through
  /// How the second's points must be turned (rad) and moved (m) about `middle_base` to lie on what the first
  /// sees, base axes, and the covariance of that from the clouds alone; large where they do not show it.
  Vector6d turn_shift = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Identity();
  Eigen::Vector3d middle_base = Eigen::Vector3d::Zero();
  double turn_rad = 0, shift_m = 0;  ///< of turn_shift, where the clouds show it
  double sigmas = 0;  ///< of both poses and the clouds, per degree of freedom; 1 is what chance makes of it

  /// Beyond this the two poses cannot both be right, or something was moved between their calibrations.
  static constexpr double kMostSigmas = 2;
  bool disagrees() const { return has_overlap && !(sigmas <= kMostSigmas); }
};

/// Point-to-plane, robustly, of the second sensor's background on the first's, in the base frame; pose and
/// the range errors of both are free (RangeError). Neither robot nor calibration takes part: what one of them
/// gets wrong shows here. Each background must have been learnt from about where its pose puts the sensor.
CrossCheck cross_check(const CheckedSensor& first, const CheckedSensor& second);

}  // namespace calibrd
