// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/calibration/observability.hpp"

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

/// The directions that make a pose uncertain, in plain words.
std::string named(const std::vector<WeakDirection>& weak, bool is_rotation) {
  std::string text;
  for (const WeakDirection& direction : weak)
    if (direction.is_rotation == is_rotation)
      text += (text.empty() ? ", least of all " : " and ") + direction.what;
  return text;
}

/// Share of the robot in a view that is where it should be, or behind something.
double found_or_hidden(const SurfaceTally& tally) {
  return share(tally.agreeing + tally.occluded, tally.predicted);
}

/// Where nothing stands behind the robot it cannot be seen through: then it is only missing.
double usually_found(const Evidence& evidence) {
  std::vector<double> shares;
  for (const SurfaceTally& tally : evidence.views) shares.push_back(found_or_hidden(tally));
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return *middle;
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
  }

  void doubts(const Refinement& r) {
    if (result_.coverage >= settings_.least_coverage && result_.coverage < settings_.min_coverage)
      doubt("low_coverage", "only " + percent(result_.coverage) +
                                " of the robot's visible surface was found in the measurement; clear what "
                                "stands in front of the robot or add postures");
    if (r.last_step_sigmas > settings_.max_last_step_sigmas)
      doubt("not_converged", "the solution still moved when the iterations ended");
    if (result_.sigma_position_m > settings_.max_sigma_position_m)
      doubt("position_uncertain", "position is known to " + milli(result_.sigma_position_m, "mm") + " only" +
                                      named(result_.weak_directions, false) + "; add postures");
    if (result_.sigma_rotation_rad > settings_.max_sigma_rotation_rad)
      doubt("rotation_uncertain", "rotation is known to " + milli(result_.sigma_rotation_rad, "mrad") +
                                      " only" + named(result_.weak_directions, true) + "; add postures");
  }

  /// Stereo's errors hang together too, but its outlines lie where they are predicted.
  void shape(const Refinement& r, const ImageRegistration& images) {
    if (r.range_correlation > settings_.max_range_correlation &&
        r.residual_rms_m > settings_.max_unexplained_rms_m && images.outline_points > 0 &&
        images.here < settings_.min_outline_of_shape)
      reject("surface_differs",
             "whole areas of the measured surface lie " + milli(r.residual_rms_m, "mm") +
                 " off the model, and so does its outline; is this the model of this robot?");
  }

  /// What the pixels say view by view.
  void contradictions(const Evidence& evidence, const Refinement& r) {
    std::string at_odds;
    const auto views = views_at_odds(r, evidence, settings_);
    for (const std::size_t v : views) at_odds += (at_odds.empty() ? "" : ", ") + std::to_string(v);
    const std::string text =
        "what view " + at_odds +
        " shows is not where its joints put the robot, seen from where the other views see "
        "it; was the robot still, and are the joints those of the frame?";
    const double growth = evidence.held_out_residual_m.value_or(0) / std::max(r.residual_rms_m, 1e-4);
    if (share(views.size(), evidence.views.size()) > settings_.max_views_at_odds ||
        (!views.empty() && growth > settings_.doubtful_held_out_growth))
      reject("views_disagree", text);
    else if (!views.empty())
      doubt("view_disagrees", text);
    if (!evidence.held_out_residual_m) return;
    const std::string residual = "views judged by the pose of the other views stay " +
                                 milli(*evidence.held_out_residual_m, "mm") + " off the model, against " +
                                 milli(r.residual_rms_m, "mm") + " of those that were fitted";
    if (growth > settings_.max_held_out_growth)
      reject("held_out_disagrees", residual);
    else if (growth > settings_.doubtful_held_out_growth)
      doubt("held_out_disagrees", residual);
  }

  void links(const Evidence& evidence) {
    if (result_.coverage < settings_.least_coverage) return;  // then none is anywhere
    std::string unseen;
    for (std::size_t i = 0; i < std::min(evidence.links.size(), result_.links.size()); ++i) {
      const SurfaceTally& tally = evidence.links[i];
      if (tally.predicted < settings_.min_link_pixels ||
          share(tally.agreeing, tally.predicted) >= settings_.min_link_coverage)
        continue;
      if (share(tally.seen_through, tally.measured) > 0.5 && tally.measured >= settings_.min_link_pixels / 2)
        reject("link_elsewhere", result_.links[i].link +
                                     " is not where the joints put it: the sensor sees through " +
                                     percent(share(tally.seen_through, tally.measured)) +
                                     " of it; check joint order, signs and the robot model");
      else if (share(tally.agreeing, tally.predicted) < settings_.min_link_coverage / 2)
        unseen += (unseen.empty() ? "" : ", ") + result_.links[i].link;
    }
    if (!unseen.empty())
      result_.reasons.push_back(
          {"link_not_seen",
           unseen + ": predicted visible, but nothing lies where the model puts it; is a tool or cover "
                    "missing in the URDF, or does something stand in front?"});
  }

  /// Whether the images belong to the depth. Asked of a pose that the depth agrees with alone: under a wrong
  /// pose no image fits.
  void images(const ImageRegistration& images, const Refinement& r) {
    if (result_.verdict == Verdict::rejected) return;
    const double edges = share(r.contour.found, r.contour.predicted);
    if (r.contour.predicted > 0 && edges < settings_.min_contour_found)
      reject("contour_not_found",
             "only " + percent(edges) +
                 " of the robot's outline has an edge in the image; is the image registered to the depth?");
    if (images.outline_points == 0 || result_.coverage < settings_.min_coverage) return;
    const double to_beat = images.here + settings_.image_margin;
    const std::string remedy =
        "; give images of the same moment in the depth's pixel grid, or leave them out (--depth-only)";
    if (images.mirrored > to_beat && images.mirrored > images.elsewhere)
      reject("image_not_registered",
             "the robot's outline fits the image when it is mirrored left to right" + remedy);
    else if (images.elsewhere > to_beat)
      reject("image_not_registered", "the robot's outline fits the image when it is moved by " +
                                         std::to_string(images.shift_x_px) + " px to the right and " +
                                         std::to_string(images.shift_y_px) + " px down" + remedy);
    else if (images.other_view > to_beat)
      reject("image_not_registered", "the robot's outline fits the image of another view" + remedy);
    else if (images.here < settings_.min_outline_on_edges)
      reject("image_not_registered", "the robot's outline does not show in the image" + remedy);
  }

  void reject(const char* code, std::string text) { calibrd::reject(code, std::move(text), result_); }
  void doubt(const char* code, std::string text) { calibrd::doubt(code, std::move(text), result_); }

 private:
  const VerdictSettings& settings_;
  CalibrationResult& result_;
};

void describe_refinement(const Refinement& refinement, CalibrationResult& result) {
  result.covariance = refinement.covariance;
  result.sigma_rotation_rad = std::sqrt(refinement.covariance.topLeftCorner<3, 3>().trace());
  result.sigma_position_m = std::sqrt(refinement.covariance.bottomRightCorner<3, 3>().trace());
  result.depth_correction = refinement.correction;
  result.residual_rms_m = refinement.residual_rms_m;
  result.coverage = share(refinement.range.agreeing, refinement.range.predicted);
}

}  // namespace

void reject(const char* code, std::string text, CalibrationResult& result) {
  result.verdict = Verdict::rejected;
  result.reasons.push_back({code, std::move(text)});
}

void doubt(const char* code, std::string text, CalibrationResult& result) {
  if (result.verdict == Verdict::accepted) result.verdict = Verdict::uncertain;
  result.reasons.push_back({code, std::move(text)});
}

void withhold_pose(CalibrationResult& result) {
  const CalibrationResult nothing_known;
  result.T_base_sensor.reset();
  result.covariance = nothing_known.covariance;
  result.sigma_position_m = nothing_known.sigma_position_m;
  result.sigma_rotation_rad = nothing_known.sigma_rotation_rad;
  result.weak_directions.clear();
}

std::vector<std::size_t> views_at_odds(const Refinement& r, const Evidence& evidence,
                                       const VerdictSettings& settings) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < evidence.views.size(); ++v) {
    const SurfaceTally& tally = evidence.views[v];
    if (evidence.joint_pull_m[v] > std::max(settings.max_joint_pull_m, r.residual_rms_m) ||
        share(tally.seen_through, tally.measured) > settings.max_view_seen_through ||
        found_or_hidden(tally) < settings.min_view_found * usually_found(evidence))
      views.push_back(v);
  }
  return views;
}

void describe_evidence(const RobotModel& robot, const Evidence& evidence, CalibrationResult& result) {
  result.held_out_residual_m = evidence.held_out_residual_m;
  result.links.clear();
  for (std::size_t i = 0; i < evidence.links.size(); ++i)
    result.links.push_back({robot.links()[i].name, evidence.links[i].predicted,
                            share(evidence.links[i].agreeing, evidence.links[i].predicted)});
}

void judge(const Refinement& refinement, const Evidence& evidence, const VerdictSettings& settings,
           CalibrationResult& result) {
  describe_refinement(refinement, result);
  result.reasons.clear();
  result.verdict = Verdict::accepted;
  if (refinement.range.measured < settings.min_pixels) {
    reject("too_few_pixels",
           "only " + std::to_string(refinement.range.measured) +
               " robot pixels carry a measurement; bring the robot into view",
           result);
    withhold_pose(result);
    return;
  }
  result.weak_directions =
      weak_directions(refinement.covariance, refinement.T_base_sensor, evidence.robot_middle_base,
                      {settings.max_sigma_position_m, settings.max_sigma_rotation_rad});
  Judge judge(settings, result);
  judge.contradictions(refinement);
  judge.contradictions(evidence, refinement);
  judge.shape(refinement, evidence.images);
  judge.links(evidence);
  judge.images(evidence.images, refinement);
  judge.doubts(refinement);
  if (result.verdict == Verdict::rejected)
    withhold_pose(result);
  else
    result.T_base_sensor = refinement.T_base_sensor;
}

}  // namespace calibrd
