// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/range_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/registration/depth_noise.hpp"

namespace calibrd {
namespace {

/// Pixels on a block of this side share a cluster: their errors (filters, surface texture, mesh errors)
/// correlate.
constexpr int kBlockSide = 24;
static_assert(kBandRows % kBlockSide == 0);
/// Predicted depth may step this share of its depth to a neighbour before the pixel counts as rim.
constexpr float kRimStep = 0.025F;

/// Derivative of the periodic term by sine, cosine and period.
Eigen::Vector3d periodic_jacobian(const DepthCorrection& correction, double z) {
  if (correction.periodic_period_m <= 0) return Eigen::Vector3d::Zero();
  const double period = correction.periodic_period_m;
  const double phase = 2 * std::numbers::pi * z / period;
  const double sine = std::sin(phase), cosine = std::cos(phase);
  return {sine, cosine,
          -phase / period * (correction.periodic_sin_m * cosine - correction.periodic_cos_m * sine)};
}

/// A rim pixel sees the robot's edge: a fraction of a pixel decides what it measures.
bool is_rim(const VirtualMeasurement& prediction, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= prediction.width || y + 1 >= prediction.height) return true;
  const auto row = static_cast<std::size_t>(prediction.width);
  const std::size_t i = static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x);
  const float z = prediction.depth_m[i];
  for (const std::size_t neighbour : {i - 1, i + 1, i - row, i + row}) {
    if (std::abs(prediction.depth_m[neighbour] - z) > kRimStep * z) return true;
  }
  return false;
}

/// Derivative of a pixel's predicted measurement. p_sensor and n: the surface point and normal it sees
/// (sensor frame).
ParameterVector jacobian_of(const RegistrationView& view, int link, const Pose& T_base_sensor,
                            const DepthCorrection& correction, const Eigen::Vector3d& p_sensor,
                            const Eigen::Vector3d& n) {
  // The sensor moves by δ, the surface stands: along the pixel's ray the depth changes by -(u×n·δω +
  // n·δt)/(n·d).
  const double z = p_sensor.z();
  const Eigen::Vector3d n_base = T_base_sensor.linear() * n, u_base = T_base_sensor.linear() * p_sensor;
  const double factor = -correction.slope(z) * z / n.dot(p_sensor);
  ParameterVector jacobian;
  jacobian << factor * u_base.cross(n_base), factor * n_base, 1.0, z, periodic_jacobian(correction, z), 0.0,
      0.0, -factor * view.axes.motion_along(link, T_base_sensor.translation() + u_base, n_base);
  return jacobian;
}

std::size_t cluster_of(const CameraModel& camera, int x, int y_in_band) {
  return static_cast<std::size_t>(y_in_band / kBlockSide * (camera.width / kBlockSide + 1) + x / kBlockSide);
}

/// Tells what a residual is: agreeing, or something in front, or the space behind seen through.
void count(double residual, double kernel_m, RangeTally& tally) {
  ++tally.measured;
  if (residual > kernel_m) ++tally.seen_through;
  if (residual < -kernel_m) ++tally.occluded;
}

}  // namespace

void RangeTally::merge(const RangeTally& other) {
  predicted += other.predicted;
  measured += other.measured;
  agreeing += other.agreeing;
  occluded += other.occluded;
  seen_through += other.seen_through;
  whitened.insert(whitened.end(), other.whitened.begin(), other.whitened.end());
}

void observe_range(const RegistrationView& view, const VirtualMeasurement& prediction,
                   const CameraModel& camera, const Pose& T_base_sensor, const DepthCorrection& correction,
                   const RangeSettings& settings, const RowBand& rows, std::vector<Sample>& samples,
                   RangeTally& tally) {
  const int step = settings.prediction_step;
  const double pixel_size = 1 / camera.fx;
  for (int row = rows.first; row < std::min(rows.end, prediction.height); row += settings.stride) {
    for (int column = 0; column < prediction.width; column += settings.stride) {
      const std::size_t i = prediction.index(column, row);
      if (prediction.link[i] < 0 || is_rim(prediction, column, row)) continue;
      const int x = column * step, y = row * step;
      const double z = prediction.depth_m[i];
      const Eigen::Vector3d d = view.rays->at(x, y);
      const Eigen::Vector3d n = prediction.normal[i].cast<double>();
      const double cos_incidence = -n.dot(d) / d.norm();  // normals face the sensor
      if (cos_incidence < settings.min_cos_incidence) continue;
      ++tally.predicted;
      const double measured_m =
          view.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                       static_cast<std::size_t>(x)];
      if (measured_m <= 0) continue;

      const double residual = measured_m - correction.measured(z);
      count(residual, settings.kernel_m, tally);
      if (std::abs(residual) >= settings.kept_kernels * settings.kernel_m) continue;
      Sample& sample = samples.emplace_back();
      sample.depth_m = z;
      sample.cluster = cluster_of(camera, x, y - rows.first * step);
      Observation& o = sample.observation;
      o.residual = residual;
      o.robust_weight = tukey_weight(residual, settings.kernel_m);
      o.sigma = settings.sigma_factor * depth_sigma_m(z, cos_incidence, pixel_size, settings.lateral_px);
      sample.depth_per_pixel_m = depth_per_pixel_m(z, cos_incidence, pixel_size);
      o.jacobian = jacobian_of(view, prediction.link[i], T_base_sensor, correction, z * d, n);
      if (o.robust_weight <= 0) continue;
      ++tally.agreeing;
      tally.whitened.push_back(static_cast<float>(o.residual / o.sigma));
    }
  }
}

void add_range_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                         const CameraModel& camera, const Pose& T_base_sensor,
                         const DepthCorrection& correction, const RangeSettings& settings,
                         NormalEquations& equations, RangeTally& tally) {
  std::vector<Sample> samples;
  observe_range(view, prediction, camera, T_base_sensor, correction, settings, {}, samples, tally);
  for (const Sample& sample : samples) equations.add(sample.observation, sample.cluster);
}

}  // namespace calibrd
