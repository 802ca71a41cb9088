// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/edge_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kSampleStep_px = 0.5;

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

/// What the image should show along the normal, blurred as it blurs: shares of light that are constant on the
/// robot, that fall with the cosine of incidence (active illumination dims a round limb towards its rim,
/// which moves the steepest step up to a pixel inwards), and that come from beyond. One row per
/// kSampleStep_px.
class ProfileModel {
 public:
  static constexpr int kBases = 3;
  using Row = Eigen::Vector3d;

  /// Rows from -reach to +reach samples around the contour.
  ProfileModel(const RegistrationView& view, const CameraModel& camera, const Pose& T_base_sensor,
               const ContourPoint& point, int reach)
      : reach_(reach) {
    const int fine_reach = reach * kFinePerSample + kBlurRadius + 1;
    std::vector<Row> sharp(static_cast<std::size_t>(2 * fine_reach), Row(0, 0, 1));
    const Eigen::Vector2d inward = -point.outward;
    const float rim = static_cast<float>(point.p_sensor.z());
    // The cosine changes fast at the rim and slowly further in: cast few rays there and interpolate.
    int from = 0;
    Row at_from = light_at(view, camera, T_base_sensor, point.pixel + 0.5 * kFine_px * inward, rim);
    sharp[static_cast<std::size_t>(fine_reach - 1)] = at_from;
    while (from + 1 < fine_reach) {
      const int to = std::min(from + 1 + from / 3, fine_reach - 1);
      const Row at_to =
          light_at(view, camera, T_base_sensor, point.pixel + kFine_px * (to + 0.5) * inward, rim);
      for (int k = from + 1; k <= to; ++k) {
        const double share = static_cast<double>(k - from) / (to - from);
        sharp[static_cast<std::size_t>(fine_reach - 1 - k)] = (1 - share) * at_from + share * at_to;
      }
      from = to;
      at_from = at_to;
    }
    blur(sharp, fine_reach);
  }

  /// The bases at `sample` samples from the contour, outward positive.
  const Row& at(int sample) const { return rows_[static_cast<std::size_t>(sample + reach_)]; }

 private:
  static constexpr int kFinePerSample = 2;
  static constexpr double kFine_px = kSampleStep_px / kFinePerSample;
  static constexpr int kBlurRadius = 10;  // fine steps

  static Row light_at(const RegistrationView& view, const CameraModel& camera, const Pose& T_base_sensor,
                      const Eigen::Vector2d& pixel, float rim_depth_m) {
    const Eigen::Vector3d ray = camera.ray(pixel.x(), pixel.y());
    const SurfaceHit hit = view.cell.hit_along(ray, T_base_sensor);
    if (beyond(hit.depth_m, rim_depth_m)) return {0, 0, 1};
    return {1, -hit.normal.dot(ray.cast<float>()) / static_cast<float>(ray.norm()), 0};
  }

  /// Weights of fine steps at odd half steps from a sample: a pixel's width, prepare_views' smoothing and
  /// bilinear sampling together blur by 0.78 px.
  static const std::array<double, 2 * kBlurRadius>& kernel() {
    static const auto weights = [] {
      constexpr double kBlur_px = 0.78;
      std::array<double, 2 * kBlurRadius> w{};
      double sum = 0;
      for (int k = 0; k < 2 * kBlurRadius; ++k) {
        const double distance_px = kFine_px * (k - kBlurRadius + 0.5);
        sum += w[static_cast<std::size_t>(k)] = std::exp(-0.5 * std::pow(distance_px / kBlur_px, 2));
      }
      for (double& weight : w) weight /= sum;
      return w;
    }();
    return weights;
  }

  void blur(const std::vector<Row>& sharp, int fine_reach) {
    rows_.reserve(static_cast<std::size_t>(2 * reach_ + 1));
    for (int sample = -reach_; sample <= reach_; ++sample) {
      const auto first = static_cast<std::size_t>(sample * kFinePerSample + fine_reach - kBlurRadius);
      Row sum = Row::Zero();
      for (std::size_t k = 0; k < kernel().size(); ++k) sum += kernel()[k] * sharp[first + k];
      rows_.push_back(sum);
    }
  }

  int reach_;
  std::vector<Row> rows_;
};

/// Squared misfit of the profile against the model moved outward by `shift` samples, the three shares of
/// light fitted.
double misfit(const std::vector<float>& grey, int reach, const ProfileModel& model, int shift) {
  Eigen::Matrix3d normal = 1e-6 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0;
  for (int k = -reach; k <= reach; ++k) {
    const ProfileModel::Row& row = model.at(k - shift);
    const double value = grey[static_cast<std::size_t>(k + reach)];
    normal.noalias() += row * row.transpose();
    right += value * row;
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

}  // namespace

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

std::optional<Edge> find_depth_step(const RegistrationView& view, const CameraModel& camera,
                                    const ContourPoint& point, const ContourSettings& settings) {
  constexpr double kDepthEdgeSigma_px = 1.0;
  constexpr int kSure = 4;  // samples in a row on the robot, and off it
  const int reach = static_cast<int>(std::ceil(settings.search_px / kSampleStep_px)) + kSure;
  const auto rim = static_cast<float>(point.p_sensor.z());
  int on_robot = 0, off_robot = 0;
  for (int k = -reach; k <= reach; ++k) {
    const Eigen::Vector2d p = point.pixel + kSampleStep_px * k * point.outward;
    const auto x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) return std::nullopt;
    const float z = view.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                                 static_cast<std::size_t>(x)];
    if (z > 0 && z < rim - kContourStep_m) return std::nullopt;  // something in front
    const bool is_robot = z > 0 && z < rim + kContourStep_m;
    if (is_robot) {
      on_robot += 1 + off_robot;  // a short gap is a drop-out
      off_robot = 0;
      continue;
    }
    if (on_robot < kSure) {
      on_robot = 0;
      continue;
    }
    if (++off_robot == kSure) return Edge{kSampleStep_px * (k - kSure + 0.5), kDepthEdgeSigma_px};
  }
  return std::nullopt;
}

std::optional<Edge> fit_profile(const RegistrationView& view, const CameraModel& camera,
                                const Pose& T_base_sensor, const ContourPoint& point,
                                const ContourSettings& settings) {
  constexpr double kWindow_px = 4;
  constexpr double kShiftStep_px = kSampleStep_px;
  constexpr double kWorstFit = 0.15;       // of the profile's variation may stay unexplained
  constexpr double kModelFloor_px = 0.30;  // what the light model itself gets wrong
  const int reach = static_cast<int>(kWindow_px / kSampleStep_px);
  const auto grey = sample_profile(view, camera, point, reach);
  if (!grey) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(*grey);
  if (high - low < settings.min_contrast * view.image_noise) return std::nullopt;
  const int shifts = static_cast<int>(settings.search_px / kShiftStep_px);
  const ProfileModel model(view, camera, T_base_sensor, point, reach + shifts);
  std::vector<double> costs;
  for (int k = -shifts; k <= shifts; ++k) costs.push_back(misfit(*grey, reach, model, k));
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

}  // namespace calibrd
