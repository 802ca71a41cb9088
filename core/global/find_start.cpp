// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/find_start.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>

#include "core/global/field_fit.hpp"
#include "core/global/moving_points.hpp"
#include "core/global/moving_surface.hpp"
#include "core/global/point_groups.hpp"
#include "core/global/rotation_grid.hpp"
#include "core/registration/coarse_align.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kMostPlacesOfOne = 10;  // in a single view the robot may be any part of the scene
constexpr std::size_t kPolished = 6, kPolishedHarder = 60;
constexpr std::size_t kMinPoints = 8;  // per view: fewer say nothing of a shape

/// What the views that show enough motion say, ready for fitting.
struct Shapes {
  std::vector<PosedSurface> surfaces;
  std::vector<std::optional<DistanceField>> fields;
  std::vector<PostureEvidence> postures;
  std::vector<std::size_t> view_of;  // of each posture
};

Shapes gather(std::span<const RegistrationView> views, std::span<const MovingPoints> moving,
              const StartSettings& settings) {
  Shapes shapes;
  shapes.surfaces = sample_moving_surface(views, settings.surface_points);
  shapes.fields.resize(views.size());
  const auto is_usable = [&](std::size_t v) {
    return moving[v].points.size() >= kMinPoints && !shapes.surfaces[v].points.empty();
  };
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    if (is_usable(v))
      shapes.fields[v].emplace(shapes.surfaces[v].points, static_cast<float>(settings.voxel_m), 0.25F);
  });
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!is_usable(v)) continue;
    shapes.postures.push_back({&*shapes.fields[v], moving[v].points});
    shapes.view_of.push_back(v);
  }
  return shapes;
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

using Groups = std::vector<std::vector<PointGroup>>;  // per posture

Groups groups_of(std::span<const PostureEvidence> postures) {
  constexpr float kReach_m = 0.12F, kCube_m = 0.4F;
  const std::size_t most = postures.size() == 1 ? kMostPlacesOfOne : 6;
  Groups all;
  for (const PostureEvidence& posture : postures) {
    all.push_back(postures.size() == 1 ? group_by_cubes(posture.points_sensor, kCube_m, kMinPoints)
                                       : group_points(posture.points_sensor, kReach_m, kMinPoints));
    if (all.back().size() > most) all.back().resize(most);
  }
  return all;
}

/// A place of the sensor that groups of several postures agree on.
struct Place {
  Eigen::Vector3f position_base = Eigen::Vector3f::Zero();
  std::size_t postures = 0;  ///< that agree
};

/// The mean of the places nearest to `seed`, one per posture, that lie within reach of it.
Place agreed_place(const std::vector<std::vector<Eigen::Vector3f>>& places, const Eigen::Vector3f& seed) {
  constexpr float kReach_m = 0.4F;
  Place agreed;
  for (const auto& of_posture : places) {
    if (of_posture.empty()) continue;
    const auto nearest = std::ranges::min_element(
        of_posture, {}, [&](const Eigen::Vector3f& place) { return (place - seed).squaredNorm(); });
    if ((*nearest - seed).norm() > kReach_m) continue;
    agreed.position_base += *nearest;
    ++agreed.postures;
  }
  agreed.position_base /= static_cast<float>(std::max<std::size_t>(1, agreed.postures));
  return agreed;
}

/// Where a sensor of that orientation may stand so that in most postures a group of moving points lies where
/// the robot is. What else moves (people) agrees on no place.
std::vector<Pose> placed(const Eigen::Matrix3d& R_base_sensor, const Shapes& shapes, const Groups& groups,
                         std::size_t most_places) {
  constexpr float kSame_m = 0.3F;
  const Eigen::Matrix3f R = R_base_sensor.cast<float>();
  std::vector<std::vector<Eigen::Vector3f>> places(groups.size());
  for (std::size_t p = 0; p < groups.size(); ++p) {
    const Eigen::Vector3f middle = visible_middle(shapes.surfaces[shapes.view_of[p]], R.col(2));
    for (const PointGroup& group : groups[p]) places[p].push_back(middle - R * group.middle);
  }
  std::vector<Place> candidates;
  for (const auto& of_posture : places)
    for (const Eigen::Vector3f& seed : of_posture) candidates.push_back(agreed_place(places, seed));
  std::ranges::stable_sort(candidates, std::greater<>{}, &Place::postures);
  std::vector<Pose> poses;
  for (const Place& place : candidates) {
    const Eigen::Vector3d position = place.position_base.cast<double>();
    if (poses.size() == most_places) break;
    if (std::ranges::any_of(
            poses, [&](const Pose& other) { return (other.translation() - position).norm() < kSame_m; }))
      continue;
    Pose& pose = poses.emplace_back(Pose::Identity());
    pose.linear() = R_base_sensor;
    pose.translation() = position;
  }
  return poses;
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

std::vector<FieldFit> fit_all(const Shapes& shapes, std::vector<FieldFit> fits,
                              const FieldFitSettings& settings) {
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t i) {
    fits[i] = fit_to_fields(shapes.postures, fits[i].T_base_sensor, settings);
  });
  return fits;
}

std::vector<FieldFit> first_guesses(const Shapes& shapes, const StartSettings& settings) {
  const Groups groups = groups_of(shapes.postures);
  const std::size_t places = groups.size() == 1 ? kMostPlacesOfOne : settings.places;
  std::vector<FieldFit> guesses;
  for (const Eigen::Matrix3d& R : even_rotations(settings.rotations))
    for (const Pose& pose : placed(R, shapes, groups, places)) guesses.push_back({pose, 1});
  return guesses;
}

std::size_t stride_for(const Shapes& shapes, std::size_t wanted) {
  std::size_t points = 0;
  for (const PostureEvidence& posture : shapes.postures) points += posture.points_sensor.size();
  return std::max<std::size_t>(1, points / wanted);
}

std::vector<FieldFit> quick_fits(const Shapes& shapes, const StartSettings& settings) {
  return fit_all(shapes, first_guesses(shapes, settings), {0.3, 0.1, 8, stride_for(shapes, 150)});
}

/// What poses are judged by.
struct Scene {
  std::span<const RegistrationView> views;
  std::span<const MovingPoints> moving;
  const CameraModel& camera;
};

std::vector<StartHypothesis> ranked(const Scene& scene, std::span<const Pose> poses) {
  const std::vector<RenderScore> scores = render_scores(scene.views, scene.moving, scene.camera, poses, {});
  std::vector<StartHypothesis> starts;
  for (std::size_t i = 0; i < poses.size(); ++i) starts.push_back({poses[i], scores[i]});
  std::ranges::stable_sort(starts, std::greater<>{}, [](const auto& s) { return s.score.value(); });
  std::vector<StartHypothesis> distinct;
  for (const StartHypothesis& start : starts)
    if (std::ranges::none_of(distinct, [&](const StartHypothesis& better) {
          return is_same(start.T_base_sensor, better.T_base_sensor);
        }))
      distinct.push_back(start);
  return distinct;
}

/// The best `count` of the fits, fitted closer, and the better half of them judged by rendering.
std::vector<StartHypothesis> judged(const Scene& scene, const Shapes& shapes,
                                    const std::vector<FieldFit>& fits, std::size_t count) {
  const FieldFitSettings close{0.12, 0.04, 10, stride_for(shapes, 600)};
  const std::vector<FieldFit> best =
      distinct_best(fit_all(shapes, distinct_best(fits, count), close), std::max<std::size_t>(1, count / 2));
  std::vector<Pose> poses;
  for (const FieldFit& fit : best) poses.push_back(fit.T_base_sensor);
  return ranked(scene, poses);
}

/// The best few pulled onto the measured surface, and judged again. Fits to moving points that are half a
/// person stop short of it.
std::vector<StartHypothesis> polished(const Scene& scene, const std::vector<StartHypothesis>& starts,
                                      std::size_t count) {
  CoarseSettings settings;
  settings.iterations = 12;
  settings.reduction = 8;
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Pose& pose = starts[i].T_base_sensor;
    poses.push_back(i < count ? coarse_align(scene.views, scene.camera, pose, settings) : pose);
  }
  return ranked(scene, poses);
}

/// Keeps those postures in which least moved: where more did, people walked by.
void keep_calmest(Shapes& shapes) {
  constexpr std::size_t kLeast = 4;
  std::vector<std::size_t> order(shapes.postures.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t p) { return shapes.postures[p].points_sensor.size(); });
  order.resize(std::min(order.size(), std::max(kLeast, order.size() / 2)));
  std::vector<PostureEvidence> postures;
  std::vector<std::size_t> view_of;
  for (const std::size_t p : order) {
    postures.push_back(shapes.postures[p]);
    view_of.push_back(shapes.view_of[p]);
  }
  shapes.postures = std::move(postures);
  shapes.view_of = std::move(view_of);
}

bool is_better(const std::vector<StartHypothesis>& starts, const std::vector<StartHypothesis>& than) {
  return !starts.empty() && starts.front().score.value() > than.front().score.value();
}

}  // namespace

std::vector<StartHypothesis> find_starts(std::span<const RegistrationView> views,
                                         std::span<const MovingPoints> moving, const CameraModel& camera,
                                         const StartSettings& settings) {
  const Scene scene{views, moving, camera};
  Shapes shapes = gather(views, moving, settings);
  if (shapes.postures.empty()) return {};
  const std::vector<FieldFit> fits = quick_fits(shapes, settings);
  std::vector<StartHypothesis> starts = judged(scene, shapes, fits, settings.kept_fits);
  if (starts.empty()) return starts;  // what moves forms no group
  // People who walk by can hide the truth among fits that explain them better: then all are looked at.
  if (starts.front().score.value() < settings.convincing)
    starts = polished(scene, judged(scene, shapes, fits, fits.size()), kPolished);
  if (starts.front().score.value() >= settings.hopeless || views.size() == 1) return starts;
  StartSettings harder = settings;
  harder.rotations *= 3;
  harder.places *= 2;
  keep_calmest(shapes);
  const std::vector<FieldFit> more = quick_fits(shapes, harder);
  auto found = polished(scene, judged(scene, shapes, more, more.size()), kPolishedHarder);
  return is_better(found, starts) ? found : starts;
}

}  // namespace calibrd
