// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/contour_edges.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace calibrd {
namespace {

/// Contour points on a block of this side share a cluster: what the light does to one limb's rim it does all
/// along.
constexpr int kBlockSide = 64;
constexpr float kContourStep_m = 0.03F;  // what lies this much further back is beyond the contour
constexpr float kOccluder_m = 0.05F;     // what was measured this much in front hides the contour
constexpr int kMargin = 4;
constexpr double kSampleStep_px = 0.5;

struct ContourPoint {
  Eigen::Vector2d pixel;     // on the contour, to a fraction of a pixel
  Eigen::Vector2d outward;   // unit normal in the image
  Eigen::Vector3d p_sensor;  // on the robot, just inside
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
std::optional<ContourPoint> locate(const RegistrationView& view, const CameraModel& camera,
                                   const Pose& T_base_sensor, int x, int y, float z,
                                   const Eigen::Vector2d& outward) {
  constexpr int kBisections = 5;
  const Eigen::Vector2d start(x, y);
  const auto depth_at = [&](double t) {
    const Eigen::Vector2d p = start + t * outward;
    return view.cell.hit_along(camera.ray(p.x(), p.y()), T_base_sensor).depth_m;
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

/// Grey values along the normal, kSampleStep_px apart, `reach` samples to both sides of the contour.
std::optional<std::vector<float>> sample_profile(const RegistrationView& view, const CameraModel& camera,
                                                 const ContourPoint& point, int reach) {
  std::vector<float> grey(static_cast<std::size_t>(2 * reach + 1));
  for (int k = -reach; k <= reach; ++k) {
    const Eigen::Vector2d p = point.pixel + kSampleStep_px * k * point.outward;
    if (p.x() < 1 || p.y() < 1 || p.x() >= camera.width - 2 || p.y() >= camera.height - 2)
      return std::nullopt;
    grey[static_cast<std::size_t>(k + reach)] = bilinear(view.image, camera.width, p);
  }
  return grey;
}

/// Where an image edge lies (px along the normal from the predicted contour), and how sure that is.
struct Edge {
  double distance_px;
  double sigma_px;
};

/// The strongest near step in the image.
std::optional<Edge> find_step(const RegistrationView& view, const CameraModel& camera,
                              const ContourPoint& point, const ContourSettings& settings) {
  const int half = static_cast<int>(std::ceil(settings.search_px / kSampleStep_px));
  const int reach = half + 2;  // two more on each side for the slope
  const auto grey = sample_profile(view, camera, point, reach);
  if (!grey) return std::nullopt;
  const auto slope = [&](int k) {  // over two pixels
    return std::abs((*grey)[static_cast<std::size_t>(k + 2)] - (*grey)[static_cast<std::size_t>(k - 2)]);
  };
  const auto threshold = static_cast<float>(settings.min_contrast * view.image_noise);
  std::optional<Edge> best;
  double best_score = 0;
  for (int k = 3; k + 3 < static_cast<int>(grey->size()); ++k) {
    const float here = slope(k), before = slope(k - 1), after = slope(k + 1);
    if (here < threshold || here < before || here <= after) continue;
    const double bend = before - 2.0 * here + after;
    const double top = bend < 0 ? 0.5 * (before - after) / bend : 0.0;
    const double distance = kSampleStep_px * (k - reach + top);
    const double score =
        here * std::exp(-2 * distance * distance / (settings.search_px * settings.search_px));
    if (score > best_score) {
      best_score = score;
      best = Edge{distance, settings.sigma_px};
    }
  }
  return best;
}

/// What the image should show along the normal, blurred as it blurs: shares of light that are constant on the
/// robot, that fall with the cosine of incidence (active illumination dims a round limb towards its rim,
/// which moves the steepest step up to a pixel inwards), and that come from beyond.
class ProfileModel {
 public:
  static constexpr int kBases = 3;
  using Row = Eigen::Matrix<double, 1, kBases>;

  ProfileModel(const RegistrationView& view, const CameraModel& camera, const Pose& T_base_sensor,
               const ContourPoint& point, double reach_px)
      : reach_(static_cast<int>(std::ceil((reach_px + kBlurReach_px) / kFine_px))) {
    std::vector<Row> sharp;
    const float rim = static_cast<float>(point.p_sensor.z());
    for (int k = -reach_; k <= reach_; ++k) {
      const Eigen::Vector2d p = point.pixel + kFine_px * (k + 0.5) * point.outward;
      const Eigen::Vector3d ray = camera.ray(p.x(), p.y());
      Row row(0, 0, 1);
      if (k < 0) {
        const SurfaceHit hit = view.cell.hit_along(ray, T_base_sensor);
        if (!beyond(hit.depth_m, rim))
          row << 1, -hit.normal.dot(ray.cast<float>()) / static_cast<float>(ray.norm()), 0;
      }
      sharp.push_back(row);
    }
    blur(sharp);
  }

  /// The bases at a distance (px) from the contour, outward positive.
  Row at(double distance_px) const {
    const double place = distance_px / kFine_px + reach_ - 0.5;
    const auto k = std::clamp(static_cast<int>(place), 0, static_cast<int>(blurred_.size()) - 2);
    const double share = place - k;
    return (1 - share) * blurred_[static_cast<std::size_t>(k)] +
           share * blurred_[static_cast<std::size_t>(k) + 1];
  }

 private:
  static constexpr double kFine_px = 0.25;
  static constexpr double kBlur_px =
      0.78;  // a pixel's width, prepare_views' smoothing and bilinear sampling together
  static constexpr double kBlurReach_px = 2.5;

  void blur(const std::vector<Row>& sharp) {
    const int radius = static_cast<int>(kBlurReach_px / kFine_px);
    std::vector<double> kernel;
    for (int k = -radius; k <= radius; ++k)
      kernel.push_back(std::exp(-0.5 * std::pow(k * kFine_px / kBlur_px, 2)));
    const int last = static_cast<int>(sharp.size()) - 1;
    for (int i = 0; i <= last; ++i) {
      Row sum = Row::Zero();
      double weight = 0;
      for (int k = -radius; k <= radius; ++k) {
        sum += kernel[static_cast<std::size_t>(k + radius)] *
               sharp[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
        weight += kernel[static_cast<std::size_t>(k + radius)];
      }
      blurred_.push_back(sum / weight);
    }
  }

  int reach_;
  std::vector<Row> blurred_;
};

/// Squared misfit of the profile against the model moved outward by `shift_px`, the three shares of light
/// fitted.
double misfit(const std::vector<float>& grey, int reach, const ProfileModel& model, double shift_px) {
  Eigen::Matrix3d normal = 1e-6 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0;
  for (int k = -reach; k <= reach; ++k) {
    const ProfileModel::Row row = model.at(kSampleStep_px * k - shift_px);
    const double value = grey[static_cast<std::size_t>(k + reach)];
    normal.noalias() += row.transpose() * row;
    right += value * row.transpose();
    squares += value * value;
  }
  return std::max(squares - right.dot(normal.ldlt().solve(right)), 0.0);
}

double variation(const std::vector<float>& grey) {
  double sum = 0, squares = 0;
  for (const double value : grey) {
    sum += value;
    squares += value * value;
  }
  return squares - sum * sum / static_cast<double>(grey.size());
}

/// The move (px, along the normal) by which the modelled light profile fits the image; nothing when it
/// explains the profile badly, which is then of something else.
std::optional<Edge> fit_profile(const RegistrationView& view, const CameraModel& camera,
                                const Pose& T_base_sensor, const ContourPoint& point,
                                const ContourSettings& settings) {
  constexpr double kWindow_px = 4;
  constexpr double kShiftStep_px = 0.5;
  constexpr double kWorstFit = 0.15;       // of the profile's variation may stay unexplained
  constexpr double kModelFloor_px = 0.15;  // what the light model itself gets wrong
  const int reach = static_cast<int>(kWindow_px / kSampleStep_px);
  const auto grey = sample_profile(view, camera, point, reach);
  if (!grey) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(*grey);
  if (high - low < settings.min_contrast * view.image_noise) return std::nullopt;
  const ProfileModel model(view, camera, T_base_sensor, point, kWindow_px + settings.search_px);
  const int shifts = static_cast<int>(settings.search_px / kShiftStep_px);
  std::vector<double> costs;
  for (int k = -shifts; k <= shifts; ++k) costs.push_back(misfit(*grey, reach, model, kShiftStep_px * k));
  const auto best = static_cast<int>(std::ranges::min_element(costs) - costs.begin());
  if (best == 0 || best + 1 == static_cast<int>(costs.size())) return std::nullopt;
  const double before = costs[static_cast<std::size_t>(best - 1)],
               here = costs[static_cast<std::size_t>(best)],
               after = costs[static_cast<std::size_t>(best + 1)];
  const double bend = before - 2 * here + after;
  if (here > kWorstFit * variation(*grey) || bend <= 0) return std::nullopt;
  // Least squares: variance of the move = 2 s² / curvature of the cost, s² from the misfit. Smoothing and
  // half-pixel sampling leave about a third of the samples independent.
  constexpr double kDependence = 3;
  const double freedom = static_cast<double>(grey->size()) / kDependence - 2;
  const double variance = 2 * here / std::max(freedom, 1.0) * kShiftStep_px * kShiftStep_px / bend;
  return Edge{kShiftStep_px * (best - shifts + 0.5 * (before - after) / bend),
              std::hypot(kModelFloor_px, std::sqrt(variance))};
}

Observation observe(const RegistrationView& view, int link, const ContourPoint& point, const Edge& edge,
                    const CameraModel& camera, const Pose& T_base_sensor, const ContourSettings& settings) {
  Observation o;
  o.residual = edge.distance_px - settings.shift_px;
  o.sigma = edge.sigma_px;
  const double x = o.residual / settings.kernel_px;
  o.robust_weight = std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
  // The sensor moves by δ: in the image the contour moves by -Jπ Rᵀ (δω×u + δt), seen along its normal.
  const Eigen::Vector3d pull_sensor = camera.projection_jacobian(point.p_sensor).transpose() * point.outward;
  const Eigen::Vector3d a = -(T_base_sensor.linear() * pull_sensor);
  const Eigen::Vector3d u_base = T_base_sensor.linear() * point.p_sensor;
  o.jacobian.setZero();
  o.jacobian.head<6>() << u_base.cross(a), a;
  o.jacobian[kContourShift] = 1;
  o.jacobian.tail<kMaxJointZeros>() =
      -view.axes.derivative(link, T_base_sensor.translation() + u_base).transpose() * a;
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
  residuals_px.insert(residuals_px.end(), other.residuals_px.begin(), other.residuals_px.end());
  whitened.insert(whitened.end(), other.whitened.begin(), other.whitened.end());
}

void add_contour_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                           const CameraModel& camera, const Pose& T_base_sensor,
                           const ContourSettings& settings, NormalEquations& equations, ContourTally& tally) {
  if (view.image.empty()) return;
  const int blocks_per_row = camera.width / kBlockSide + 1;
  for (int y = kMargin; y + kMargin < camera.height; ++y) {
    for (int x = kMargin; x + kMargin < camera.width; ++x) {
      if ((x + y) % settings.stride != 0 || !is_contour(prediction, x, y)) continue;
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      const float z = prediction.depth_m[i];
      if (view.depth_m[i] > 0 && view.depth_m[i] < z - kOccluder_m) continue;
      const auto outward = outward_normal(prediction, x, y, z);
      if (!outward) continue;
      const auto point = locate(view, camera, T_base_sensor, x, y, z, *outward);
      if (!point) continue;
      ++tally.predicted;
      const auto edge = settings.fit_profile ? fit_profile(view, camera, T_base_sensor, *point, settings)
                                             : find_step(view, camera, *point, settings);
      if (!edge) continue;
      const Observation o = observe(view, prediction.link[i], *point, *edge, camera, T_base_sensor, settings);
      if (o.robust_weight <= 0) continue;
      ++tally.found;
      tally.residuals_px.push_back(static_cast<float>(o.residual));
      tally.whitened.push_back(static_cast<float>(o.residual / o.sigma));
      equations.add(o, static_cast<std::size_t>(y / kBlockSide * blocks_per_row + x / kBlockSide));
    }
  }
}

}  // namespace calibrd
