// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/range_residuals.hpp"

#include <cmath>
#include <numbers>

#include "core/registration/depth_noise.hpp"

namespace calibrd {
namespace {

/// Pixels on a block of this side share a cluster: their errors (filters, surface texture, mesh errors)
/// correlate.
constexpr int kBlockSide = 24;
/// Predicted depth may step this share of its depth to a neighbour before the pixel counts as rim.
constexpr float kRimStep = 0.025F;

double tukey_weight(double residual, double kernel) {
  const double x = residual / kernel;
  if (std::abs(x) >= 1) return 0;
  return (1 - x * x) * (1 - x * x);
}

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
      0.0, -factor * view.axes.derivative(link, T_base_sensor.translation() + u_base).transpose() * n_base;
  return jacobian;
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

void add_range_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                         const CameraModel& camera, const Pose& T_base_sensor,
                         const DepthCorrection& correction, const RangeSettings& settings,
                         NormalEquations& equations, RangeTally& tally, std::vector<RangeSample>* samples) {
  const int blocks_per_row = camera.width / kBlockSide + 1;
  for (int y = 0; y < camera.height; y += settings.stride) {
    for (int x = 0; x < camera.width; x += settings.stride) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      if (prediction.link[i] < 0 || is_rim(prediction, x, y)) continue;
      const double z = prediction.depth_m[i];
      const Eigen::Vector3d d = view.rays->at(x, y);
      const Eigen::Vector3d n = prediction.normal[i].cast<double>();
      const double slope = n.dot(d);  // below 0: normals face the sensor
      const double cos_incidence = -slope / d.norm();
      if (cos_incidence < settings.min_cos_incidence) continue;
      ++tally.predicted;
      if (view.depth_m[i] <= 0) continue;

      Observation o;
      o.residual = view.depth_m[i] - correction.measured(z);
      count(o.residual, settings.kernel_m, tally);
      o.robust_weight = tukey_weight(o.residual, settings.kernel_m);
      if (o.robust_weight <= 0) continue;
      ++tally.agreeing;
      o.sigma = settings.sigma_factor * depth_sigma_m(z, cos_incidence, 1 / camera.fx);
      tally.whitened.push_back(static_cast<float>(o.residual / o.sigma));

      o.jacobian = jacobian_of(view, prediction.link[i], T_base_sensor, correction, z * d, n);
      if (samples != nullptr) samples->push_back({o, z});
      equations.add(o, static_cast<std::size_t>(y / kBlockSide * blocks_per_row + x / kBlockSide));
    }
  }
}

}  // namespace calibrd
