// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/calibration/calibrate.hpp"
#include "core/registration/refine.hpp"

namespace calibrd {

/// What a pose must show before it may be served.
struct VerdictSettings {
  double min_coverage =
      0.55;  ///< share of visible robot pixels that the measurement agrees with; below: uncertain
  double least_coverage = 0.25;     ///< ... and below this: rejected
  double max_seen_through = 0.15;   ///< share through which the sensor looks into the space behind the robot
  double min_contour_found = 0.35;  ///< share of contour points with an image edge; asked only with images
  std::size_t min_pixels = 1500;    ///< robot pixels over all views
  double max_sigma_position_m = 0.0035;
  double max_sigma_rotation_rad = 0.0035;
  double max_residual_rms_m = 0.02;
  double max_offset_m = 0.06;  ///< a range offset beyond this is no sensor's: intrinsics or model are wrong
  double max_scale_error = 0.015;  ///< likewise of the range scale
  double max_joint_zero = 3e-3;    ///< joint zeros beyond this (rad or m): wrong zeros, joint order or model
  double max_last_step_sigmas = 1.0;  ///< a solution that still moves by its own uncertainty has not settled
};

/// Fills verdict, reasons, pose and uncertainty of `result` from where the refinement ended.
/// Rejected: the measurement contradicts the pose. Uncertain: nothing contradicts it, but too little speaks
/// for it.
void judge(const Refinement& refinement, const VerdictSettings& settings, CalibrationResult& result);

}  // namespace calibrd
