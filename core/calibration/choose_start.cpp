// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/choose_start.hpp"

#include <algorithm>

#include "core/global/moving_points.hpp"
#include "core/registration/coarse_align.hpp"

namespace calibrd {
namespace {

constexpr double kClear = 0.2;       // a margin of rough scores that needs no second look
constexpr std::size_t kSeconds = 3;  // hypotheses that get it
constexpr double kSame_m = 0.1, kSame_rad = 0.09;

bool is_same(const Pose& a, const Pose& b) {
  const Vector6d apart = difference(a, b);
  return apart.head<3>().norm() < kSame_rad && apart.tail<3>().norm() < kSame_m;
}

/// Best first.
std::vector<StartHypothesis> judged_finer(std::span<const RegistrationView> views,
                                          std::span<const MovingPoints> moving, const CameraModel& camera,
                                          std::vector<Pose> poses) {
  CoarseSettings align;
  align.reduction = 8;
  for (Pose& pose : poses) pose = coarse_align(views, camera, pose, align);
  const auto scores = render_scores(views, moving, camera, poses, {6, 0.025});
  std::vector<StartHypothesis> starts;
  for (std::size_t i = 0; i < poses.size(); ++i) starts.push_back({poses[i], scores[i]});
  std::ranges::stable_sort(starts, std::greater<>{}, [](const auto& s) { return s.score.value(); });
  return starts;
}

ChosenStart first_of(const std::vector<StartHypothesis>& starts) {
  constexpr std::size_t kMostOthers = 2;
  ChosenStart chosen{starts.front().T_base_sensor, {}, std::nullopt};
  for (const StartHypothesis& start : starts) {
    if (chosen.others.size() == kMostOthers) break;
    if (is_same(start.T_base_sensor, chosen.T_base_sensor)) continue;
    if (!chosen.margin) chosen.margin = starts.front().score.value() - start.score.value();
    chosen.others.push_back(start.T_base_sensor);
  }
  return chosen;
}

}  // namespace

std::vector<StartHypothesis> starts_of_one(const RegistrationView& view, const CameraModel& camera) {
  constexpr std::size_t kMost = 5;
  const std::span views(&view, 1);
  auto starts = find_starts(views, robot_candidates(views, camera), camera, {});
  if (starts.size() > kMost) starts.resize(kMost);
  return starts;
}

std::optional<ChosenStart> choose_start(std::span<const RegistrationView> views, const CameraModel& camera) {
  const auto moving = robot_candidates(views, camera);
  const auto starts = find_starts(views, moving, camera, {});
  if (starts.empty()) return std::nullopt;
  const ChosenStart chosen = first_of(starts);
  if (!chosen.margin || *chosen.margin > kClear) return chosen;
  std::vector<Pose> poses;
  for (const StartHypothesis& start : starts)
    if (poses.size() < kSeconds) poses.push_back(start.T_base_sensor);
  return first_of(judged_finer(views, moving, camera, std::move(poses)));
}

}  // namespace calibrd
