// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/diagnose.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/calibration/alternatives.hpp"
#include "core/calibration/free_joints.hpp"
#include "core/global/find_start.hpp"
#include "core/global/moving_points.hpp"
#include "core/registration/coarse_align.hpp"

namespace calibrd {
namespace {

using Views = std::vector<RegistrationView>;

constexpr double kScoreTolerance_m = 0.02;
constexpr double kLeastAgreeing = 0.9;      // share of a free fit's pixels
constexpr double kLeastSpread_rad = 0.005;  // of a joint over the views: less is a joint's zero, or nothing

std::string degrees(double angle_rad) {
  char text[24];
  std::snprintf(text, sizeof text, "%.1f degrees", 57.29577951308232 * angle_rad);
  return text;
}

/// The views under one explanation, and the camera to see them by.
struct Input {
  Views views;
  CameraModel camera;
  std::vector<std::size_t> taken = {};  // of all views
};

void mirror(std::vector<float>& depth, const CameraModel& camera) {
  for (int y = 0; y < camera.height; ++y) {
    const auto row = depth.begin() + static_cast<std::ptrdiff_t>(y) * camera.width;
    std::reverse(row, row + camera.width);
  }
}

Input under(const Alternative& alternative, std::span<const RegistrationView> views,
            const CameraModel& camera, std::size_t count) {
  std::vector<std::vector<double>> joints;
  for (const RegistrationView& view : views) joints.push_back(view.reported_joints);
  Input input{{}, alternative.camera(camera)};
  const auto rays = std::make_shared<const PixelRays>(input.camera);
  for (std::size_t v = 0; v < views.size() && input.views.size() < count; ++v) {
    auto positions = alternative.joints(joints, v);
    if (positions.empty()) continue;
    RegistrationView view = views[v];
    view.image.clear();
    view.rays = rays;
    view.reported_joints = std::move(positions);
    view.apply_zeros(Eigen::Matrix<double, kMaxJointZeros, 1>::Zero());
    if (alternative.mirrored) mirror(view.depth_m, camera);
    input.views.push_back(std::move(view));
    input.taken.push_back(v);
  }
  return input;
}

std::vector<double> scores_of(const Input& input, std::span<const MovingPoints> moving,
                              std::span<const Pose> poses) {
  std::vector<double> values;
  for (const RenderScore& score :
       render_scores(input.views, moving, input.camera, poses, {6, kScoreTolerance_m}))
    values.push_back(score.value());
  return values;
}

/// How well the best of the poses explains the views once it is pulled onto them.
double best_score(const Input& input, std::span<const MovingPoints> moving, std::vector<Pose> poses) {
  if (poses.empty() || input.views.size() < 2) return 0;
  CoarseSettings align;
  align.iterations = 12;
  align.reduction = 8;
  for (Pose& pose : poses) pose = coarse_align(input.views, input.camera, pose, align);
  return std::ranges::max(scores_of(input, moving, poses));
}

/// Of the joints there are many explanations: each is searched in less detail.
std::vector<Pose> searched(const Input& input, std::span<const MovingPoints> moving, bool thoroughly) {
  if (input.views.size() < 2) return {};
  StartSettings settings;
  settings.hopeless = -1;
  settings.convincing = -1;  // most explanations are wrong: no second look at what fits badly
  if (!thoroughly) {
    settings.rotations = 100;
    settings.surface_points = 1500;
    settings.voxel_m = 0.05;
    settings.kept_fits = 16;
  }
  std::vector<Pose> poses;
  for (const StartHypothesis& start : find_starts(input.views, moving, input.camera, settings)) {
    poses.push_back(start.T_base_sensor);
    if (poses.size() == 2) break;
  }
  return poses;
}

/// Holds what was found so far and what the next must beat.
class AlternativeSearch {
 public:
  AlternativeSearch(std::span<const RegistrationView> views, const CameraModel& camera,
                    const TriedPoses& tried, const DiagnoseSettings& settings)
      : views_(views),
        camera_(camera),
        tried_(tried),
        settings_(settings),
        deadline_(std::chrono::steady_clock::now() + settings.budget),
        as_it_came_(under({}, views, camera, settings.views)),
        moving_(find_moving_points(as_it_came_.views, camera, {})),
        score_as_it_came_(best_score(as_it_came_, moving_, tried.T_base_sensor)) {
    to_beat_ = std::max({settings.least_score, score_as_it_came_ + settings.least_gain,
                         score_as_it_came_ + settings.least_mended * (1 - score_as_it_came_)});
  }

  std::optional<Reason> run() {
    const auto all = alternatives(views_.front().cell.robot().position_names());
    for (const Alternative& alternative : all) try_from(tried_.T_base_sensor, alternative);
    if (!best_) {
      for (const Alternative& alternative : all)
        if (alternative.of_sensor) try_from({}, alternative);
    }
    if (!best_) consider_moving_robot();
    if (!best_) {
      for (const Alternative& alternative : all)
        if (!alternative.of_sensor) try_from({}, alternative);
    }
    if (!best_ && !is_late() && something_moved() &&
        (tried_.surface_differs || score_as_it_came_ < settings_.least_score))
      best_ = {
          "robot_model_wrong",
          "what moved fits this robot from no place, nor with other joint orders, signs or moments: is this "
          "the model of this robot, with what it carries?"};
    return best_;
  }

 private:
  /// From anywhere, when there are no poses.
  void try_from(const std::vector<Pose>& poses, const Alternative& alternative) {
    if (score_ >= settings_.convincing || is_late()) return;
    const Input input = under(alternative, views_, camera_, settings_.views);
    const bool same_points =
        !alternative.mirrored && input.taken == as_it_came_.taken && input.camera == as_it_came_.camera;
    const std::vector<MovingPoints> other =
        same_points ? std::vector<MovingPoints>{} : find_moving_points(input.views, input.camera, {});
    const std::span<const MovingPoints> moving = same_points ? moving_ : other;
    consider(
        best_score(input, moving, poses.empty() ? searched(input, moving, alternative.of_sensor) : poses),
        alternative.reason);
  }
  bool is_late() const { return std::chrono::steady_clock::now() >= deadline_; }
  void consider(double score, const Reason& reason) {
    if (score <= to_beat_) return;
    to_beat_ = score_ = score;
    best_ = reason;
  }
  void consider_moving_robot() {
    Input input = as_it_came_;
    const FreeJointsFit fit = fit_free_joints(input.views, camera_, tried_.T_base_sensor.back());
    const double open = 1 - fit.agreeing_before;
    if (fit.spread_rad < kLeastSpread_rad || fit.agreeing_after < kLeastAgreeing ||
        1 - fit.agreeing_after > (1 - settings_.least_mended) * open)
      return;
    best_ = {
        "joints_not_of_frame",
        "the views fit when the joints of each may differ by up to " + degrees(fit.largest_rad) +
            " from those given: the robot moved, or frames and joints are of different moments; let it stand "
            "still, check the stamps and the latency"};
  }
  bool something_moved() const {
    return std::ranges::any_of(moving_, [](const MovingPoints& moving) {
      return std::ranges::count(moving.mask, std::uint8_t{1}) > 1000;
    });
  }

  std::span<const RegistrationView> views_;
  const CameraModel& camera_;
  const TriedPoses& tried_;
  const DiagnoseSettings& settings_;
  std::chrono::steady_clock::time_point deadline_;
  Input as_it_came_;
  std::vector<MovingPoints> moving_;  // as it came
  double score_as_it_came_;
  double to_beat_ = 1, score_ = -1;
  std::optional<Reason> best_;
};

}  // namespace

std::optional<Reason> diagnose(std::span<const RegistrationView> views, const CameraModel& camera,
                               const TriedPoses& tried, const DiagnoseSettings& settings) {
  return AlternativeSearch(views, camera, tried, settings).run();
}

}  // namespace calibrd
