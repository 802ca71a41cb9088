// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/calibration/calibrate.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// How well one view fits what a known pose predicts.
struct PoseCheck {
  bool enough_evidence = false;  ///< enough robot pixels in view, with measurements, to say anything
  bool agrees = false;           ///< the pose explains what is measured on the robot
  double agreement = 0;          ///< share of measured robot pixels within tolerance of the prediction, 0..1
  double median_residual_m = 0;  ///< measured minus predicted depth, corrected for the known range bias
  std::size_t robot_pixels = 0;  ///< predicted robot pixels that carry a measurement
};

/// Compares one view with what `T_base_sensor` predicts. `cell` is moved to the view's joints.
PoseCheck check_pose(VirtualCell& cell, const CameraModel& camera, const View& view,
                     const Pose& T_base_sensor, const DepthCorrection& correction);

}  // namespace calibrd
