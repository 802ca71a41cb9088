// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/contour_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace calibrd {
namespace {

constexpr int kBlockSide = 24;
constexpr float kContourStep_m = 0.03F;  // what lies this much further back is beyond the contour
constexpr float kOccluder_m = 0.05F;     // what was measured this much in front hides the contour
constexpr int kMargin = 4;
constexpr double kSampleStep_px = 0.5;

struct ContourPoint {
  Eigen::Vector2d pixel;      // on the contour, to a fraction of a pixel
  Eigen::Vector2d outward;    // unit normal in the image
  Eigen::Vector3d p_sensor;   // on the robot, just inside
};

bool beyond(float depth, float contour_depth) { return depth <= 0 || depth > contour_depth + kContourStep_m; }

/// Direction from the robot to what lies beyond it, from the shares of a disc around the pixel.
std::optional<Eigen::Vector2d> outward_normal(const VirtualMeasurement& m, int x, int y, float z) {
  constexpr int kRadius = 4;
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
std::optional<ContourPoint> locate(const RegistrationView& view, const CameraModel& camera, const Pose& T_base_sensor,
                                   int x, int y, float z, const Eigen::Vector2d& outward) {
  constexpr int kBisections = 5;
  const Eigen::Vector2d start(x, y);
  const auto depth_at = [&](double t) {
    const Eigen::Vector2d p = start + t * outward;
    return view.cell.depth_along(camera.ray(p.x(), p.y()), T_base_sensor);
  };
  double inside = 0, outside = 1.5;
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

/// Grey value between pixels; `p` lies inside the image by the caller's margin.
float bilinear(const std::vector<float>& image, int width, const Eigen::Vector2d& p) {
  const auto x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const auto fx = static_cast<float>(p.x() - x), fy = static_cast<float>(p.y() - y);
  const float* row = image.data() + static_cast<std::ptrdiff_t>(y) * width + x;
  return (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * row[width] + fx * row[width + 1]);
}

/// Signed distance (px, along the normal) from the predicted contour to the image edge that fits it best.
std::optional<double> find_edge(const RegistrationView& view, const CameraModel& camera, const ContourPoint& point,
                                const ContourSettings& settings) {
  const int half = static_cast<int>(std::ceil(settings.search_px / kSampleStep_px));
  const int samples = 2 * (half + 2) + 1;  // two more on each side for the slope
  std::array<float, 256> grey{};
  if (samples > static_cast<int>(grey.size())) return std::nullopt;
  for (int k = 0; k < samples; ++k) {
    const Eigen::Vector2d p = point.pixel + kSampleStep_px * (k - half - 2) * point.outward;
    if (p.x() < 1 || p.y() < 1 || p.x() >= camera.width - 2 || p.y() >= camera.height - 2) return std::nullopt;
    grey[static_cast<std::size_t>(k)] = bilinear(view.image, camera.width, p);
  }
  const auto slope = [&](int k) {  // over two pixels
    return std::abs(grey[static_cast<std::size_t>(k + 2)] - grey[static_cast<std::size_t>(k - 2)]);
  };
  const auto threshold = static_cast<float>(settings.min_contrast * view.image_noise);
  std::optional<double> best;
  double best_score = 0;
  for (int k = 3; k + 3 < samples; ++k) {
    const float here = slope(k), before = slope(k - 1), after = slope(k + 1);
    if (here < threshold || here < before || here <= after) continue;
    const double bend = before - 2.0 * here + after;
    const double top = bend < 0 ? 0.5 * (before - after) / bend : 0.0;
    const double distance = kSampleStep_px * (k - half - 2 + top);
    const double score = here * std::exp(-2 * distance * distance / (settings.search_px * settings.search_px));
    if (score > best_score) {
      best_score = score;
      best = distance;
    }
  }
  return best;
}

Observation observe(const ContourPoint& point, double distance_px, const CameraModel& camera, const Pose& T_base_sensor,
                    const ContourSettings& settings) {
  Observation o;
  o.residual = distance_px;
  o.sigma = settings.sigma_px;
  const double x = distance_px / settings.kernel_px;
  o.robust_weight = std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
  // The sensor moves by δ: in the image the contour moves by -Jπ Rᵀ (δω×u + δt), seen along its normal.
  const Eigen::Vector3d pull_sensor = camera.projection_jacobian(point.p_sensor).transpose() * point.outward;
  const Eigen::Vector3d a = -(T_base_sensor.linear() * pull_sensor);
  const Eigen::Vector3d u_base = T_base_sensor.linear() * point.p_sensor;
  o.jacobian << u_base.cross(a), a, 0.0, 0.0;
  return o;
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
  whitened.insert(whitened.end(), other.whitened.begin(), other.whitened.end());
}

void add_contour_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                           const CameraModel& camera, const Pose& T_base_sensor, const ContourSettings& settings,
                           NormalEquations& equations, ContourTally& tally) {
  if (view.image.empty()) return;
  const int blocks_per_row = camera.width / kBlockSide + 1;
  int turn = 0;
  for (int y = kMargin; y + kMargin < camera.height; ++y) {
    for (int x = kMargin; x + kMargin < camera.width; ++x) {
      if (!is_contour(prediction, x, y) || ++turn % settings.stride != 0) continue;
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      const float z = prediction.depth_m[i];
      if (view.depth_m[i] > 0 && view.depth_m[i] < z - kOccluder_m) continue;
      const auto outward = outward_normal(prediction, x, y, z);
      if (!outward) continue;
      const auto point = locate(view, camera, T_base_sensor, x, y, z, *outward);
      if (!point) continue;
      ++tally.predicted;
      const auto distance = find_edge(view, camera, *point, settings);
      if (!distance) continue;
      const Observation o = observe(*point, *distance, camera, T_base_sensor, settings);
      if (o.robust_weight <= 0) continue;
      ++tally.found;
      tally.whitened.push_back(static_cast<float>(o.residual / o.sigma));
      equations.add(o, static_cast<std::size_t>(y / kBlockSide * blocks_per_row + x / kBlockSide));
    }
  }
}

}  // namespace calibrd
