// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>

#include "core/calibration/calibrate.hpp"
#include "core/registration/contour_edges.hpp"
#include "core/registration/range_residuals.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

struct RefineSettings {
  double offset_prior_m = 0.02;     ///< standard deviation of the range offset before anything was seen
  double scale_prior = 0.005;       ///< and of the range scale
  double periodic_prior_m = 0.004;  ///< and of the periodic term's amplitude
  double period_prior = 0.07;       ///< and of its period about the best candidate, as a share of it
  double image_shift_prior_px = 0.3;
  double depth_shift_prior_px = 2;  ///< stereo fattens what stands in front, time of flight frays it
  double joint_zero_prior = 1e-3;   ///< standard deviation of a joint's zero, rad or m; 0: trust the zeros
  bool use_depth_outline = true;    ///< false: range alone, and images where there are any
  int final_renderings = 5;
  /// A move this small against the uncertainty of the result ends the iteration.
  double convergence_sigmas = 0.5;
  std::function<bool(double)> keep_going;  ///< called with the progress 0..1; false ends the refinement early
};

/// Where the refinement ended and what speaks for it.
struct Refinement {
  Pose T_base_sensor = Pose::Identity();
  DepthCorrection correction;
  /// Joint zeros found (true minus reported position) and their standard deviations, rad or m. The pose is
  /// the one that is right for the joints as reported; the zeros are not hidden in it.
  JointZeros joint_zeros = JointZeros::Zero();
  JointZeros joint_zero_sigmas = JointZeros::Zero();
  /// Edges lie this far (px) outside the predicted contours, in the image and in the depth.
  double image_shift_px = 0, depth_shift_px = 0;
  Matrix6d covariance = Matrix6d::Zero();  ///< of perturbed()'s δ, correlation of errors included
  double last_step_sigmas = 0;  ///< drift of the pose over the last moves, in its own standard deviations
  double residual_rms_m = 0;    ///< of the range residuals that agree
  double sigma_factor = 1;      ///< noise found over noise expected
  double lateral_px = kUsualLateral_px;  ///< lateral noise found
  double range_correlation = 1;  ///< times that range errors are less independent than their number says
  RangeTally range;
  ContourTally contour;        ///< of the image
  ContourTally depth_contour;  ///< of the depth
};

/// Gauss-Newton on range (point-to-plane on projective pairs) and, where views carry images, contour
/// residuals of all views jointly; range offset and scale are estimated beside the pose. Kernels shrink from
/// centimetres to the noise that is found. Start within about 2 cm and 1° (see coarse_align).
Refinement refine(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
                  const RefineSettings& settings);

}  // namespace calibrd
