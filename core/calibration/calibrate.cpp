// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "core/calibration/choose_start.hpp"
#include "core/calibration/diagnose.hpp"
#include "core/calibration/evidence.hpp"
#include "core/calibration/observability.hpp"
#include "core/calibration/verdict.hpp"
#include "core/paper/calibrate_by_paper.hpp"
#include "core/registration/coarse_align.hpp"
#include "core/registration/refine.hpp"

namespace calibrd {
namespace {

std::optional<Reason> unusable(const RobotModel& robot, const CameraModel& camera,
                               std::span<const View> views) {
  if (views.empty())
    return Reason{"no_views", "there is no view to calibrate from; record at least one posture"};
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const std::string name = "view " + std::to_string(i);
    if (view.depth.width != camera.width || view.depth.height != camera.height ||
        view.depth.raw.size() != pixels)
      return Reason{"wrong_image_size", name + ": the depth image has not the size of the camera model"};
    if (view.image && (view.image->width != camera.width || view.image->height != camera.height ||
                       view.image->pixels.size() != pixels))
      return Reason{"wrong_image_size", name + ": the image has not the size of the camera model"};
    if (view.joint_positions_rad.size() != robot.position_count())
      return Reason{"wrong_joint_count", name + ": the robot model needs " +
                                             std::to_string(robot.position_count()) + " joint positions"};
    if (!std::ranges::all_of(view.joint_positions_rad, [](double q) { return std::isfinite(q); }))
      return Reason{"joint_not_finite", name + ": a joint position is not a finite number"};
    if (std::ranges::all_of(view.depth.raw, [](std::uint16_t raw) { return raw == 0; }))
      return Reason{"empty_frame", name + ": the depth image holds no measurement; is the sensor covered?"};
  }
  return std::nullopt;
}

double ms_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

CalibrationResult rejected(Reason reason, std::size_t views) {
  CalibrationResult result;
  result.views = static_cast<int>(views);
  result.reasons.push_back(std::move(reason));
  return result;
}

std::vector<JointZero> named_zeros(const RobotModel& robot, const Refinement& refined) {
  std::vector<JointZero> zeros;
  for (std::size_t j = 0; j < std::min<std::size_t>(robot.position_count(), kMaxJointZeros); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    zeros.push_back({robot.position_names()[j], refined.joint_zeros[row], refined.joint_zero_sigmas[row]});
  }
  return zeros;
}

std::string shown(const Pose& T_base_sensor) {
  char text[96];
  const Eigen::Vector3d p = T_base_sensor.translation(), sight = T_base_sensor.linear().col(2);
  std::snprintf(text, sizeof text, "x %.2f, y %.2f, z %.2f m, looking along (%.1f, %.1f, %.1f)", p.x(), p.y(),
                p.z(), sight.x(), sight.y(), sight.z());
  return text;
}

/// A second place that explains the views as well makes the first one a matter of luck.
void judge_margin(const std::optional<ChosenStart>& chosen, const VerdictSettings& settings,
                  CalibrationResult& result) {
  if (!chosen) return;
  result.runner_up_margin = chosen->margin;
  if (chosen->margin && *chosen->margin < settings.min_margin)
    doubt("ambiguous",
          "a sensor at " + shown(chosen->T_base_runner_up) +
              " would explain the views almost as well; add postures that differ more, or give a guess",
          result);
}

bool has(const CalibrationResult& result, std::string_view code) {
  return std::ranges::any_of(result.reasons, [code](const Reason& reason) { return reason.code == code; });
}

/// Adds what would make the rejected views fit, where something does.
void explain(std::vector<RegistrationView>& views, const CameraModel& camera, const TriedPoses& tried,
             CalibrationResult& result) {
  // An image that is not registered explains itself, and so does a range that is off.
  constexpr std::string_view kPoseIsWrong[] = {
      "free_space_violation",   "robot_not_found",    "views_disagree",
      "link_elsewhere",         "held_out_disagrees", "large_residual",
      "joint_zero_implausible", "low_coverage",       "surface_differs"};
  if (std::ranges::none_of(kPoseIsWrong, [&](std::string_view code) { return has(result, code); })) return;
  for (RegistrationView& view : views) view.apply_zeros(Eigen::Matrix<double, kMaxJointZeros, 1>::Zero());
  if (auto reason = diagnose(views, camera, tried, {})) result.reasons.push_back(*std::move(reason));
}

/// The verdict with everything that speaks for and against it.
CalibrationResult judged(std::vector<RegistrationView>& views, const CameraModel& camera,
                         const Refinement& refined, const std::optional<ChosenStart>& chosen,
                         const CalibrationSettings& settings) {
  const RobotModel& robot = views.front().cell.robot();
  CalibrationResult result;
  const Evidence evidence = gather_evidence(views, camera, refined);
  describe_evidence(robot, evidence, result);
  judge(refined, evidence, {}, result);
  judge_margin(chosen, {}, result);
  if (result.verdict == Verdict::rejected)
    explain(
        views, camera,
        {{refined.T_base_sensor}, settings.guess_T_base_sensor.has_value(), has(result, "surface_differs")},
        result);
  if (result.T_base_sensor) {
    result.joint_zeros = named_zeros(robot, refined);
    result.workspace = workspace_errors(result.covariance, *result.T_base_sensor, settings.workspace);
  }
  return result;
}

CalibrationResult calibrate_in_full(const VirtualCell& cell, const CameraModel& camera,
                                    std::span<const View> views, const CalibrationSettings& settings) {
  const auto begin = std::chrono::steady_clock::now();
  const auto is_cancelled = [&] { return settings.cancelled != nullptr && settings.cancelled->load(); };
  PrepareSettings prepare;
  prepare.use_images = !settings.depth_only;
  std::vector<RegistrationView> prepared = prepare_views(cell, camera, views, prepare);
  std::optional<ChosenStart> chosen;
  std::optional<Pose> rough = settings.guess_T_base_sensor;
  if (!rough && (chosen = choose_start(prepared, camera))) rough = chosen->T_base_sensor;
  if (!rough)
    return rejected({"nothing_moved",
                     "without a guess at least two postures are needed between which the robot moves in "
                     "view; add postures or give a guess"},
                    views.size());
  const Pose start = coarse_align(prepared, camera, *rough, {});

  RefineSettings refinement;
  refinement.keep_going = [&](double progress) {
    if (settings.on_progress) settings.on_progress(0.2 + 0.8 * progress);
    return !is_cancelled();
  };
  const Refinement refined = refine(prepared, camera, start, refinement);
  if (is_cancelled()) return rejected({"cancelled", "the calibration was cancelled"}, views.size());

  const double time_to_pose_ms = ms_since(begin);
  CalibrationResult result = judged(prepared, camera, refined, chosen, settings);
  result.time_to_pose_ms = time_to_pose_ms;
  result.views = static_cast<int>(views.size());
  return result;
}

}  // namespace

CalibrationResult calibrate(const VirtualCell& cell, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings) {
  const RobotModel& robot = cell.robot();
  const auto begin = std::chrono::steady_clock::now();
  if (auto reason = unusable(robot, camera, views)) return rejected(*std::move(reason), views.size());
  CalibrationResult result = settings.method == Method::paper
                                 ? calibrate_by_paper(robot, camera, views, settings)
                                 : calibrate_in_full(cell, camera, views, settings);
  result.used_guess = settings.guess_T_base_sensor.has_value();
  result.time_total_ms = ms_since(begin);
  return result;
}

CalibrationResult calibrate(const RobotModel& robot, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings) {
  return calibrate(VirtualCell(robot), camera, views, settings);
}

}  // namespace calibrd
