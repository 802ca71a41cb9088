// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/contour_edges.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/registration/edge_search.hpp"

namespace calibrd {
namespace {

/// Contour points on a block of this side share a cluster: what the light does to one limb's rim it does all
/// along.
constexpr int kBlockSide = 72;
static_assert(kBandRows % kBlockSide == 0);
constexpr float kOccluder_m = 0.05F;  // what was measured this much in front hides the contour
constexpr int kMargin = 4;

/// Direction from the robot to what lies beyond it, from the shares of a disc around the pixel.
std::optional<Eigen::Vector2d> outward_normal(const VirtualMeasurement& m, int x, int y, float z) {
  constexpr int kRadius = kMargin;
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      if (dx * dx + dy * dy > kRadius * kRadius) continue;
      const auto i = static_cast<std::size_t>((y + dy) * m.width + x + dx);
      pull += (beyond(m.depth_m[i], z) ? 1.0 : -1.0) * Eigen::Vector2d(dx, dy);
    }
  }
  if (pull.norm() < kRadius) return std::nullopt;  // a thin tip: no side to speak of
  return pull.normalized();
}

/// Moves along the normal to where rays stop meeting the robot.
std::optional<ContourPoint> locate(const RegistrationView& view, const CameraModel& camera,
                                   const Pose& T_base_sensor, const Eigen::Vector2d& start, double reach_px,
                                   float z, const Eigen::Vector2d& outward) {
  constexpr int kBisections = 5;
  const auto depth_at = [&](double t) {
    const Eigen::Vector2d p = start + t * outward;
    return view.cell.hit_along(camera.ray(p.x(), p.y()), T_base_sensor).depth_m;
  };
  double inside = 0, outside = reach_px;
  float inside_depth = z;
  if (!beyond(depth_at(outside), z)) return std::nullopt;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (inside + outside);
    const float depth = depth_at(middle);
    if (beyond(depth, z)) {
      outside = middle;
    } else {
      inside = middle;
      inside_depth = depth;
    }
  }
  const Eigen::Vector2d pixel = start + 0.5 * (inside + outside) * outward;
  return ContourPoint{pixel, outward, inside_depth * camera.ray(pixel.x(), pixel.y())};
}

Observation observe(const RegistrationView& view, const ContourPoint& point, const Edge& edge,
                    const CameraModel& camera, const Pose& T_base_sensor, const ContourSettings& settings) {
  Observation o;
  o.residual = edge.distance_px - settings.shift_px;
  o.sigma = edge.sigma_px;
  o.robust_weight = tukey_weight(o.residual, settings.kernel_px);
  // The sensor moves by δ: in the image the contour moves by -Jπ Rᵀ (δω×u + δt), seen along its normal.
  const Eigen::Vector3d pull_sensor = camera.projection_jacobian(point.p_sensor).transpose() * point.outward;
  const Eigen::Vector3d a = -(T_base_sensor.linear() * pull_sensor);
  const Eigen::Vector3d u_base = T_base_sensor.linear() * point.p_sensor;
  o.jacobian.setZero();
  o.jacobian.head<6>() << u_base.cross(a), a;
  o.jacobian[settings.source == EdgeSource::image ? kImageShift : kDepthShift] = 1;
  o.jacobian.tail<kMaxJointZeros>() =
      -view.axes.motion_along(point.link, T_base_sensor.translation() + u_base, a);
  return o;
}

std::optional<Edge> find_edge(const RegistrationView& view, const CameraModel& camera,
                              const Pose& T_base_sensor, const ContourPoint& point,
                              const ContourSettings& settings) {
  if (settings.source == EdgeSource::depth) return find_depth_step(view, camera, point, settings);
  return settings.fit_profile ? fit_profile(view, camera, T_base_sensor, point, settings)
                              : find_step(view, camera, point, settings);
}

bool is_contour(const VirtualMeasurement& m, int x, int y) {
  const auto row = static_cast<std::size_t>(m.width);
  const std::size_t i = static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x);
  const float z = m.depth_m[i];
  return m.link[i] >= 0 && (beyond(m.depth_m[i - 1], z) || beyond(m.depth_m[i + 1], z) ||
                            beyond(m.depth_m[i - row], z) || beyond(m.depth_m[i + row], z));
}

}  // namespace

void ContourTally::merge(const ContourTally& other) {
  predicted += other.predicted;
  found += other.found;
  residuals_px.insert(residuals_px.end(), other.residuals_px.begin(), other.residuals_px.end());
  whitened.insert(whitened.end(), other.whitened.begin(), other.whitened.end());
}

std::vector<ContourPoint> find_contour(const RegistrationView& view, const VirtualMeasurement& prediction,
                                       const CameraModel& camera, const Pose& T_base_sensor,
                                       const ContourSearch& search) {
  const int step = search.prediction_step, blocks_per_row = camera.width / kBlockSide + 1;
  const double reach_px = 1.5 * step;
  std::vector<ContourPoint> contour;
  for (int row = std::max(kMargin, search.rows.first);
       row < std::min(search.rows.end, prediction.height - kMargin); ++row) {
    for (int column = kMargin; column + kMargin < prediction.width; ++column) {
      if (!is_contour(prediction, column, row) || (column + row) % search.stride != 0) continue;
      const int x = column * step, y = row * step;
      const float z = prediction.depth_m[prediction.index(column, row)];
      const float measured_m =
          view.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                       static_cast<std::size_t>(x)];
      if (measured_m > 0 && measured_m < z - kOccluder_m) continue;
      const auto outward = outward_normal(prediction, column, row, z);
      if (!outward) continue;
      auto point = locate(view, camera, T_base_sensor, Eigen::Vector2d(x, y), reach_px, z, *outward);
      if (!point) continue;
      point->link = prediction.link[prediction.index(column, row)];
      point->cluster = static_cast<std::size_t>((y - search.rows.first * step) / kBlockSide * blocks_per_row +
                                                x / kBlockSide);
      contour.push_back(*point);
    }
  }
  return contour;
}

void observe_contour(const RegistrationView& view, std::span<const ContourPoint> contour,
                     const CameraModel& camera, const Pose& T_base_sensor, const ContourSettings& settings,
                     std::vector<Sample>& samples, ContourTally& tally) {
  if (settings.search_px <= 0 || (settings.source == EdgeSource::image && view.image.empty())) return;
  tally.predicted += contour.size();
  for (const ContourPoint& point : contour) {
    const auto edge = find_edge(view, camera, T_base_sensor, point, settings);
    if (!edge) continue;
    const Observation o = observe(view, point, *edge, camera, T_base_sensor, settings);
    samples.push_back({o, point.cluster});
    if (o.robust_weight <= 0) continue;
    ++tally.found;
    tally.residuals_px.push_back(static_cast<float>(o.residual));
    tally.whitened.push_back(static_cast<float>(o.residual / o.sigma));
  }
}

}  // namespace calibrd
