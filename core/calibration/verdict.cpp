// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/verdict.hpp"

#include <cmath>
#include <cstdio>

namespace calibrd {
namespace {

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

std::string milli(double value, const char* unit) {
  char text[24];
  std::snprintf(text, sizeof text, "%.2f %s", 1e3 * value, unit);
  return text;
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// Of a rejected pose nothing is known: a small sigma beside it would claim the opposite.
void forget_uncertainty(CalibrationResult& result) {
  const CalibrationResult nothing_known;
  result.covariance = nothing_known.covariance;
  result.sigma_position_m = nothing_known.sigma_position_m;
  result.sigma_rotation_rad = nothing_known.sigma_rotation_rad;
}

class Judge {
 public:
  Judge(const VerdictSettings& settings, CalibrationResult& result) : settings_(settings), result_(result) {}

  void contradictions(const Refinement& r) {
    const double seen_through = share(r.range.seen_through, r.range.measured);
    if (seen_through > settings_.max_seen_through)
      reject(
          "free_space_violation",
          percent(seen_through) +
              " of the robot's pixels measure the space behind it: the robot is not where this pose puts it");
    if (result_.coverage < settings_.least_coverage)
      reject("robot_not_found", "only " + percent(result_.coverage) +
                                    " of the robot's visible surface was found in the measurement; is the "
                                    "robot in view, and is the guess "
                                    "within a few centimetres and degrees?");
    if (r.residual_rms_m > settings_.max_residual_rms_m)
      reject("large_residual",
             "the measured surface stays " + milli(r.residual_rms_m, "mm") + " off the model");
    if (std::abs(r.correction.offset_m) > settings_.max_offset_m ||
        std::abs(r.correction.scale - 1) > settings_.max_scale_error)
      reject("range_implausible", "the range would have to be off by " + milli(r.correction.offset_m, "mm") +
                                      " and " + milli(r.correction.scale - 1, "per mille") +
                                      "; check the sensor's intrinsics and the robot model");
    if (r.joint_zeros.cwiseAbs().maxCoeff() > settings_.max_joint_zero)
      reject("joint_zero_implausible", "a joint would have to be off by " +
                                           milli(r.joint_zeros.cwiseAbs().maxCoeff(), "mrad") +
                                           "; check joint order, signs, zeros and robot model");
    const double edges = share(r.contour.found, r.contour.predicted);
    if (r.contour.predicted > 0 && edges < settings_.min_contour_found)
      reject("contour_not_found",
             "only " + percent(edges) +
                 " of the robot's outline has an edge in the image; is the image registered to the depth?");
  }

  void doubts(const Refinement& r) {
    if (result_.coverage >= settings_.least_coverage && result_.coverage < settings_.min_coverage)
      doubt("low_coverage", "only " + percent(result_.coverage) +
                                " of the robot's visible surface was found in the measurement; clear what "
                                "stands in front of the robot "
                                "or add postures");
    if (r.last_step_sigmas > settings_.max_last_step_sigmas)
      doubt("not_converged", "the solution still moved when the iterations ended");
    if (result_.sigma_position_m > settings_.max_sigma_position_m)
      doubt("position_uncertain",
            "position is known to " + milli(result_.sigma_position_m, "mm") + " only; add postures");
    if (result_.sigma_rotation_rad > settings_.max_sigma_rotation_rad)
      doubt("rotation_uncertain",
            "rotation is known to " + milli(result_.sigma_rotation_rad, "mrad") + " only; add postures");
  }

 private:
  void reject(const char* code, std::string text) {
    result_.verdict = Verdict::rejected;
    result_.reasons.push_back({code, std::move(text)});
  }
  void doubt(const char* code, std::string text) {
    if (result_.verdict == Verdict::accepted) result_.verdict = Verdict::uncertain;
    result_.reasons.push_back({code, std::move(text)});
  }
  const VerdictSettings& settings_;
  CalibrationResult& result_;
};

}  // namespace

void judge(const Refinement& refinement, const VerdictSettings& settings, CalibrationResult& result) {
  result.covariance = refinement.covariance;
  result.sigma_rotation_rad = std::sqrt(refinement.covariance.topLeftCorner<3, 3>().trace());
  result.sigma_position_m = std::sqrt(refinement.covariance.bottomRightCorner<3, 3>().trace());
  result.depth_correction = refinement.correction;
  result.residual_rms_m = refinement.residual_rms_m;
  result.coverage = share(refinement.range.agreeing, refinement.range.predicted);
  result.reasons.clear();

  if (refinement.range.measured < settings.min_pixels) {
    result.verdict = Verdict::rejected;
    result.reasons.push_back(
        {"too_few_pixels", "only " + std::to_string(refinement.range.measured) +
                               " robot pixels carry a measurement; bring the robot into view"});
    forget_uncertainty(result);
    return;
  }
  result.verdict = Verdict::accepted;
  Judge judge(settings, result);
  judge.contradictions(refinement);
  judge.doubts(refinement);
  if (result.verdict == Verdict::rejected) {
    forget_uncertainty(result);
  } else {
    result.T_base_sensor = refinement.T_base_sensor;
  }
}

}  // namespace calibrd
