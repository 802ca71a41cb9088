// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/calibration/calibrate.hpp"
#include "core/calibration/evidence.hpp"
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
  double max_sigma_position_m = 0.003;
  double max_sigma_rotation_rad = 0.003;
  double max_residual_rms_m = 0.02;
  double max_offset_m = 0.06;  ///< a range offset beyond this is no sensor's: intrinsics or model are wrong
  double max_scale_error = 0.015;  ///< likewise of the range scale
  double max_joint_zero = 3e-3;    ///< joint zeros beyond this (rad or m): wrong zeros, joint order or model
  double max_last_step_sigmas = 1.0;  ///< a solution that still moves by its own uncertainty has not settled
  double max_range_correlation = 45;  ///< residuals that hang together more than this, and are ...
  double max_unexplained_rms_m = 0.005;  ///< ... larger than this, show another shape than the model's ...
  double min_outline_of_shape = 0.55;    ///< ... when the outline does not lie on edges either
  /// A view is at odds with the pose when freeing its joints would move the robot's surface by more than
  /// this, and by more than the residuals' own rms ...
  double max_joint_pull_m = 0.0015;
  double max_view_seen_through = 0.25;  ///< ... or when so much of the robot is seen through in it,
  double min_view_found = 0.4;          ///< ... or when less of it is found than this share of what is usual
  double max_views_at_odds = 0.2;       ///< share of the views; above: rejected, below: uncertain
  double min_link_coverage = 0.5;       ///< a link that is found less, and mostly seen through, is elsewhere
  std::size_t min_link_pixels = 60;     ///< fewer predicted pixels say nothing of a link
  double max_held_out_growth = 2;       ///< held-out residual over the residual rms; above: rejected
  double doubtful_held_out_growth = 1.5;  ///< ... above: uncertain
  double min_outline_on_edges = 0.3;      ///< see ImageRegistration::here
  double image_margin = 0.03;  ///< by which an outline must lie better elsewhere to count as misplaced
  double min_margin = 0.05;    ///< over a runner-up that differs; below: uncertain
};

/// Fills verdict, reasons, pose and uncertainty of `result` from where the refinement ended.
/// Rejected: the measurement contradicts the pose. Uncertain: nothing contradicts it, but too little speaks
/// for it.
/// `result.links` and `held_out_residual_m` are filled by describe_evidence() before.
void judge(const Refinement& refinement, const Evidence& evidence, const VerdictSettings& settings,
           CalibrationResult& result);

/// The views in which the robot is not where their joints put it.
std::vector<std::size_t> views_at_odds(const Refinement& refinement, const Evidence& evidence,
                                       const VerdictSettings& settings);

/// Fills what the evidence says of links and held-out views.
void describe_evidence(const RobotModel& robot, const Evidence& evidence, CalibrationResult& result);

/// Adds a reason that makes an accepted result uncertain, or a rejected one.
void doubt(const char* code, std::string text, CalibrationResult& result);
void reject(const char* code, std::string text, CalibrationResult& result);

/// Takes pose and uncertainty off a rejected result: of a rejected pose nothing is known, and a small sigma
/// beside it would claim the opposite.
void withhold_pose(CalibrationResult& result);

}  // namespace calibrd
