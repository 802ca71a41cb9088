// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/find_start.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "core/global/field_fit.hpp"
#include "core/global/moving_points.hpp"
#include "core/global/moving_surface.hpp"
#include "core/global/rotation_grid.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kMinPoints = 8;  // per view: fewer say nothing of a shape

/// What the views that show enough motion say, ready for fitting.
struct Evidence {
  std::vector<MovingPoints> moving;
  std::vector<PosedSurface> surfaces;
  std::vector<std::optional<DistanceField>> fields;
  std::vector<PostureEvidence> postures;
  std::vector<std::size_t> view_of;  // of each posture
};

Evidence gather(std::span<const RegistrationView> views, const CameraModel& camera,
                const StartSettings& settings) {
  Evidence evidence;
  evidence.moving = find_moving_points(views, camera, {});
  evidence.surfaces = sample_moving_surface(views, settings.surface_points);
  evidence.fields.resize(views.size());
  const auto is_usable = [&](std::size_t v) {
    return evidence.moving[v].points.size() >= kMinPoints && !evidence.surfaces[v].points.empty();
  };
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    if (is_usable(v))
      evidence.fields[v].emplace(evidence.surfaces[v].points, static_cast<float>(settings.voxel_m), 0.25F);
  });
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!is_usable(v)) continue;
    evidence.postures.push_back({&*evidence.fields[v], evidence.moving[v].points});
    evidence.view_of.push_back(v);
  }
  return evidence;
}

/// Middle of what a far sensor that looks along `direction` (base frame) sees of a surface: facing points,
/// each with its projected area.
Eigen::Vector3f visible_middle(const PosedSurface& surface, const Eigen::Vector3f& direction) {
  constexpr std::size_t kStride = 16;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float weights = 0;
  for (std::size_t i = 0; i < surface.points.size(); i += kStride) {
    const float weight = std::max(0.0F, -surface.normals[i].dot(direction));
    sum += weight * surface.points[i];
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3f(sum / weights) : surface.points.front();
}

/// The pose of one orientation that puts the middles of what moved onto the middles of the robot.
Pose placed(const Eigen::Matrix3d& R_base_sensor, const Evidence& evidence,
            const std::vector<Eigen::Vector3f>& middles_sensor) {
  Pose T_base_sensor = Pose::Identity();
  T_base_sensor.linear() = R_base_sensor;
  Eigen::Vector3f shift = Eigen::Vector3f::Zero();
  const Eigen::Matrix3f R = R_base_sensor.cast<float>();
  for (std::size_t p = 0; p < evidence.postures.size(); ++p)
    shift += visible_middle(evidence.surfaces[evidence.view_of[p]], R.col(2)) - R * middles_sensor[p];
  T_base_sensor.translation() = (shift / static_cast<float>(evidence.postures.size())).cast<double>();
  return T_base_sensor;
}

std::vector<Eigen::Vector3f> middles(std::span<const PostureEvidence> postures) {
  std::vector<Eigen::Vector3f> all;
  for (const PostureEvidence& posture : postures) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const auto& p : posture.points_sensor) sum += p;
    all.push_back(sum / static_cast<float>(posture.points_sensor.size()));
  }
  return all;
}

bool is_same(const Pose& a, const Pose& b) {
  const Vector6d apart = difference(a, b);
  // The sensor's place alone may differ much when both look at the robot from the same side.
  return apart.head<3>().norm() < 0.15 && apart.tail<3>().norm() < 0.15;
}

/// The best `count` that are not the same, by cost.
std::vector<FieldFit> distinct_best(std::vector<FieldFit> fits, std::size_t count) {
  std::ranges::stable_sort(fits, {}, &FieldFit::cost);
  std::vector<FieldFit> best;
  for (const FieldFit& fit : fits) {
    if (best.size() == count) break;
    if (std::ranges::none_of(
            best, [&](const FieldFit& other) { return is_same(fit.T_base_sensor, other.T_base_sensor); }))
      best.push_back(fit);
  }
  return best;
}

std::vector<FieldFit> fit_all(const Evidence& evidence, std::vector<FieldFit> fits,
                              const FieldFitSettings& settings) {
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t i) {
    fits[i] = fit_to_fields(evidence.postures, fits[i].T_base_sensor, settings);
  });
  return fits;
}

std::vector<FieldFit> first_guesses(const Evidence& evidence, std::size_t rotations) {
  const std::vector<Eigen::Vector3f> middles_sensor = middles(evidence.postures);
  std::vector<FieldFit> guesses;
  for (const Eigen::Matrix3d& R : even_rotations(rotations))
    guesses.push_back({placed(R, evidence, middles_sensor), 1});
  return guesses;
}

}  // namespace

std::vector<StartHypothesis> find_starts(std::span<const RegistrationView> views, const CameraModel& camera,
                                         const StartSettings& settings) {
  const Evidence evidence = gather(views, camera, settings);
  if (evidence.postures.empty()) return {};
  std::size_t points = 0;
  for (const PostureEvidence& posture : evidence.postures) points += posture.points_sensor.size();

  FieldFitSettings quick{0.3, 0.1, 8, std::max<std::size_t>(1, points / 150)};
  std::vector<FieldFit> fits = fit_all(evidence, first_guesses(evidence, settings.rotations), quick);
  fits = distinct_best(std::move(fits), settings.kept_fits);
  FieldFitSettings close{0.12, 0.04, 10, std::max<std::size_t>(1, points / 600)};
  fits = distinct_best(fit_all(evidence, std::move(fits), close), settings.kept_scored);

  std::vector<std::vector<std::uint8_t>> masks;
  for (const MovingPoints& moving : evidence.moving) masks.push_back(moving.mask);
  std::vector<Pose> poses;
  for (const FieldFit& fit : fits) poses.push_back(fit.T_base_sensor);
  const std::vector<RenderScore> scores = render_scores(views, masks, camera, poses, {});
  std::vector<StartHypothesis> starts;
  for (std::size_t i = 0; i < poses.size(); ++i) starts.push_back({poses[i], scores[i]});
  std::ranges::stable_sort(starts, std::greater<>{}, [](const auto& s) { return s.score.value(); });
  return starts;
}

}  // namespace calibrd
