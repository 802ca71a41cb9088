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
#include "core/calibration/usable_views.hpp"
#include "core/calibration/verdict.hpp"
#include "core/paper/calibrate_by_paper.hpp"
#include "core/registration/coarse_align.hpp"
#include "core/registration/refine.hpp"

namespace calibrd {
namespace {

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
          "a sensor at " + shown(chosen->others.front()) +
              " would explain the views almost as well; add postures that differ more, or give a guess",
          result);
}

bool has(const CalibrationResult& result, std::string_view code) {
  return std::ranges::any_of(result.reasons, [code](const Reason& reason) { return reason.code == code; });
}

/// Adds what would make the rejected views fit, where something does.
void explain(std::vector<RegistrationView>& views, const CameraModel& camera, const TriedPoses& tried,
             std::chrono::milliseconds budget, CalibrationResult& result) {
  // An image that is not registered explains itself, and so does a range that is off.
  constexpr std::string_view kPoseIsWrong[] = {
      "free_space_violation",   "robot_not_found",    "views_disagree",
      "link_elsewhere",         "held_out_disagrees", "large_residual",
      "joint_zero_implausible", "low_coverage",       "surface_differs"};
  if (std::ranges::none_of(kPoseIsWrong, [&](std::string_view code) { return has(result, code); })) return;
  for (RegistrationView& view : views) view.apply_zeros(Eigen::Matrix<double, kMaxJointZeros, 1>::Zero());
  DiagnoseSettings settings;
  settings.budget = budget;
  if (auto reason = diagnose(views, camera, tried, settings))
    result.reasons.insert(result.reasons.begin(), *std::move(reason));
}

/// One calibration: views made ready once, and poses tried on them.
class Calibration {
 public:
  Calibration(const VirtualCell& cell, const CameraModel& camera, std::span<const View> views,
              const CalibrationSettings& settings)
      : camera_(camera), settings_(settings), begin_(std::chrono::steady_clock::now()) {
    PrepareSettings prepare;
    prepare.use_images = !settings.depth_only;
    views_ = prepare_views(cell, camera, views, prepare);
  }

  CalibrationResult run() {
    CalibrationResult result = settings_.guess_T_base_sensor ? from_guess(*settings_.guess_T_base_sensor)
                               : views_.size() == 1          ? from_one_view()
                                                             : from_nothing();
    if (is_cancelled()) return rejected({"cancelled", "the calibration was cancelled"}, views_.size());
    result.views = static_cast<int>(views_.size());
    return result;
  }

 private:
  CalibrationResult from_guess(const Pose& guess_T_base_sensor) {
    CalibrationResult result = tried(guess_T_base_sensor, std::nullopt);
    result.used_guess = true;
    if (result.verdict != Verdict::rejected || is_cancelled()) return result;
    const Pose misled = refined_.T_base_sensor;
    if (views_.size() > 1) {
      CalibrationResult searched = from_nothing_unexplained();
      if (searched.verdict != Verdict::rejected || is_cancelled()) return searched;
    }
    explain(views_, camera_, {{misled, refined_.T_base_sensor}, has(result, "surface_differs")},
            settings_.explaining, result);
    return result;
  }

  CalibrationResult from_nothing() {
    CalibrationResult result = from_nothing_unexplained();
    if (result.verdict == Verdict::rejected && !is_cancelled())
      explain(views_, camera_, {{refined_.T_base_sensor}, has(result, "surface_differs")},
              settings_.explaining, result);
    return result;
  }

  /// A hypothesis that the measurement contradicts makes room for the next one.
  CalibrationResult from_nothing_unexplained() {
    for (RegistrationView& view : views_) view.apply_zeros(JointZeros::Zero());
    const auto chosen = choose_start(views_, camera_);
    if (!chosen)
      return rejected({"nothing_moved",
                       "nothing that could be the robot moves between the postures in view; let the arm "
                       "move in view, check the joints that come from the controller, or give a guess"},
                      views_.size());
    CalibrationResult result = tried(chosen->T_base_sensor, chosen);
    const Refinement refined = refined_;
    for (const Pose& other : chosen->others) {
      if (result.verdict != Verdict::rejected || is_cancelled()) return result;
      CalibrationResult next = tried(other, std::nullopt);
      if (next.verdict != Verdict::rejected) return next;
    }
    refined_ = refined;
    return result;
  }

  /// The robot may be any part of a single view: what is found is never more than uncertain.
  CalibrationResult from_one_view() {
    const auto starts = starts_of_one(views_[0], camera_);
    CalibrationResult best = rejected({"nothing_found", "nothing in the view looks like the robot"}, 1);
    for (const StartHypothesis& start : starts) {
      CalibrationResult next = tried(start.T_base_sensor, std::nullopt);
      const bool is_good = next.verdict != Verdict::rejected;
      if (is_good || &start == &starts.front()) best = std::move(next);
      if (is_good || is_cancelled()) break;
    }
    if (best.verdict != Verdict::rejected)
      doubt("one_view",
            "of one view without a guess anything that looks like the robot may be taken for it; add a "
            "posture, or give a guess",
            best);
    else
      best.reasons.insert(best.reasons.begin(),
                          {"one_view",
                           "one view without a guess is little to search in; add a posture "
                           "between which the robot moves in view, or give a guess"});
    // How well the pose is known were it the right one says nothing of how well it is known.
    best.covariance = CalibrationResult{}.covariance;
    best.sigma_position_m = CalibrationResult{}.sigma_position_m;
    best.sigma_rotation_rad = CalibrationResult{}.sigma_rotation_rad;
    for (const StartHypothesis& start : starts)
      best.hypotheses.push_back({start.T_base_sensor, start.score.value()});
    return best;
  }

  /// Refines a rough pose and judges what comes of it.
  CalibrationResult tried(const Pose& rough_T_base_sensor, const std::optional<ChosenStart>& chosen) {
    for (RegistrationView& view : views_) view.apply_zeros(JointZeros::Zero());
    const Pose start = coarse_align(views_, camera_, rough_T_base_sensor, {});
    RefineSettings refinement;
    refinement.keep_going = [&](double progress) {
      if (settings_.on_progress) settings_.on_progress(0.2 + 0.8 * progress);
      return !is_cancelled();
    };
    refined_ = refine(views_, camera_, start, refinement);
    const double time_to_pose_ms = ms_since(begin_);
    if (is_cancelled()) return {};
    CalibrationResult result = judged_without_odd_views(chosen, refinement);
    result.time_to_pose_ms = time_to_pose_ms;
    return result;
  }

  /// A few views in which the robot is not where their joints put it (it still moved, or something hides it)
  /// spoil no calibration from enough others: they are left out, and the rest is judged anew.
  CalibrationResult judged_without_odd_views(const std::optional<ChosenStart>& chosen,
                                             const RefineSettings& refinement) {
    constexpr std::size_t kLeastLeft = 4;
    std::vector<std::size_t> odd;
    CalibrationResult result = judged(chosen, odd);
    if (result.verdict != Verdict::uncertain || odd.empty() || views_.size() < odd.size() + kLeastLeft)
      return result;
    std::vector<RegistrationView> all = views_;
    std::string named;
    for (std::size_t i = odd.size(); i-- > 0;) {
      views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(odd[i]));
      named.insert(0, std::to_string(odd[i]) + (i + 1 < odd.size() ? ", " : ""));
    }
    Refinement refined = refine(views_, camera_, refined_.T_base_sensor, refinement);
    std::swap(refined, refined_);
    CalibrationResult of_rest = judged(chosen, odd);
    if (of_rest.verdict == Verdict::accepted) {
      of_rest.reasons.push_back({"view_left_out", "view " + named +
                                                      " does not show the robot where its joints put it, and "
                                                      "was left out; was the robot still?"});
      return of_rest;
    }
    std::swap(refined, refined_);
    views_ = std::move(all);
    return result;
  }

  /// The verdict with everything that speaks for and against it.
  CalibrationResult judged(const std::optional<ChosenStart>& chosen,
                           std::vector<std::size_t>& odd_views) const {
    const RobotModel& robot = views_.front().cell.robot();
    CalibrationResult result;
    const Evidence evidence = gather_evidence(views_, camera_, refined_);
    describe_evidence(robot, evidence, result);
    judge(refined_, evidence, {}, result);
    odd_views = views_at_odds(refined_, evidence, {});
    judge_margin(chosen, {}, result);
    if (result.verdict == Verdict::rejected)  // of what is wrong nobody asks how sure it is
      std::erase_if(result.reasons, [](const Reason& reason) {
        return reason.code == "position_uncertain" || reason.code == "rotation_uncertain";
      });
    if (result.T_base_sensor) {
      result.joint_zeros = named_zeros(robot, refined_);
      result.workspace = workspace_errors(result.covariance, *result.T_base_sensor, settings_.workspace);
    }
    return result;
  }

  bool is_cancelled() const { return settings_.cancelled != nullptr && settings_.cancelled->load(); }

  const CameraModel& camera_;
  const CalibrationSettings& settings_;
  std::chrono::steady_clock::time_point begin_;
  std::vector<RegistrationView> views_;
  Refinement refined_;  // of the pose tried last
};

}  // namespace

CalibrationResult calibrate(const VirtualCell& cell, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings) {
  if (const std::vector<View> seen = without_empty(views); !seen.empty()) {
    CalibrationResult result = calibrate(cell, camera, seen, settings);
    result.reasons.push_back(
        {"empty_frame", std::to_string(views.size() - seen.size()) +
                            " of the depth images hold no measurement and were left out; "
                            "was the sensor covered?"});
    return result;
  }
  const RobotModel& robot = cell.robot();
  const auto begin = std::chrono::steady_clock::now();
  if (auto reason = unusable(robot, camera, views)) return rejected(*std::move(reason), views.size());
  CalibrationResult result = settings.method == Method::paper
                                 ? calibrate_by_paper(robot, camera, views, settings)
                                 : Calibration(cell, camera, views, settings).run();
  result.time_total_ms = ms_since(begin);
  return result;
}

CalibrationResult calibrate(const RobotModel& robot, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings) {
  return calibrate(VirtualCell(robot), camera, views, settings);
}

}  // namespace calibrd
