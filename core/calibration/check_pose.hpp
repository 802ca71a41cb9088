// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "core/calibration/calibrate.hpp"
#include "core/calibration/track.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// How well one view fits what a known pose predicts.
struct PoseCheck {
  bool enough_evidence = false;   ///< enough robot pixels in view, with measurements, to say anything
  bool agrees = false;            ///< the pose explains what is measured on the robot
  double agreement = 0;           ///< share of measured robot pixels within tolerance of the prediction, 0..1
  double median_residual_m = 0;   ///< measured minus predicted depth, corrected for the known range bias
  std::size_t robot_pixels = 0;   ///< predicted robot pixels that carry a measurement, without hidden ones
  std::size_t hidden_pixels = 0;  ///< of the robot, by something well in front of it
  /// How far this view alone would move the robot's visible surface in the sensor's sight (m, rad) ...
  double shift_m = 0, turn_rad = 0;
  /// ... against what noise, model, joint zeros and the pose's own uncertainty explain, in standard
  /// deviations of 6 degrees of freedom.
  double shift_sigmas = 0;
  /// The same in full: turn (rad) and shift (m) of the point `middle_base` (m), base axes, if it is the
  /// sensor that moved, and the covariance that all these explain.
  Vector6d turn_shift = Vector6d::Zero();
  Matrix6d turn_shift_covariance = Matrix6d::Identity();
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< of that the pose's own, which all its checks share
  Eigen::Vector3d middle_base = Eigen::Vector3d::Zero();
};

/// Maps perturbed()'s δ about a point to turn and shift of the point that lies `lever` (m, same axes) from
/// it.
Matrix6d shift_of_point(const Eigen::Vector3d& lever);

/// Compares views with what a pose predicts. Where the view pins it down, a robot that appears 5 mm or 10
/// mrad from where the pose puts it disagrees; a direction that this one posture does not show is not
/// checked. One thread at a time.
class PoseChecker {
 public:
  /// The robot of `cell` must outlive it.
  PoseChecker(const VirtualCell& cell, const CameraModel& camera);

  /// `covariance`: of the pose, see perturbed(); zero: it is exact.
  PoseCheck check(const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
                  const Matrix6d& covariance = Matrix6d::Zero());

 private:
  /// Where the robot's visible surface lies on average, base frame.
  Eigen::Vector3d compare(const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
                          PoseCheck& check);
  View without_rim(const View& view) const;

  CameraModel camera_;
  VirtualCell cell_;
  PoseTracker tracker_;
  VirtualMeasurement prediction_;
  std::vector<std::pair<int, int>> hidden_;  // pixels of the last comparison
};

}  // namespace calibrd
