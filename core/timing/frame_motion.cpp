// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/frame_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/registration/depth_noise.hpp"
#include "core/registration/frame_pixels.hpp"
#include "core/registration/linearization.hpp"
#include "core/registration/normal_equations.hpp"
#include "core/timing/link_motion.hpp"

namespace calibrd {
namespace {

/// Over this much to both sides joint speed is taken: about a controller's cycle, so that it is not that of
/// one interpolated piece.
constexpr auto kSpeedReach = std::chrono::milliseconds(20);
/// Pixels on a block of this side (pixels of the sensor) share a cluster: their errors correlate.
constexpr int kBlockSide = 24;
constexpr double kMisfitReach_m = 0.03;
constexpr double kMinKernel_m = 0.006, kKernelSigmas = 4.7, kTypicalSigma_m = 1.6e-3;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

FrameMotion::FrameMotion(const VirtualCell& cell, const CameraModel& camera,
                         const FrameMotionSettings& settings)
    : settings_(settings), camera_(camera), sparse_camera_(camera.subsampled(settings.stride)), cell_(cell) {
  for (int v = 0; v < sparse_camera_.height; ++v)
    for (int u = 0; u < sparse_camera_.width; ++u) rays_.push_back(sparse_camera_.ray(u, v));
}

bool FrameMotion::place(const JointsAt& joints_at, Clock::time_point time) {
  const auto positions = joints_at(time);
  if (!positions || positions->size() != cell_.robot().position_count()) return false;
  cell_.set_joints(*positions);
  return true;
}

/// Predicts where the cell stands now, and lists the pixels that can be compared.
void FrameMotion::compare(const TimedFrame& frame) {
  cell_.measure(sparse_camera_, frame.T_base_sensor, prediction_);
  pixels_.clear();
  const auto clusters_per_row = static_cast<std::size_t>(camera_.width / kBlockSide + 1);
  for (int row = 0; row < prediction_.height; ++row) {
    for (int column = 0; column < prediction_.width; ++column) {
      const std::size_t i = prediction_.index(column, row);
      if (prediction_.link[i] < 0) continue;
      const double z = prediction_.depth_m[i], slope = prediction_.normal[i].cast<double>().dot(rays_[i]);
      if (-slope / rays_[i].norm() < settings_.min_cos_incidence || is_rim(prediction_, rays_, column, row))
        continue;
      const double measured = measured_m(frame.depth, settings_.stride * column, settings_.stride * row);
      if (measured <= 0) continue;
      pixels_.push_back({i, z, slope, measured - frame.correction.measured(z),
                         static_cast<std::size_t>(row * settings_.stride / kBlockSide) * clusters_per_row +
                             static_cast<std::size_t>(column * settings_.stride / kBlockSide)});
    }
  }
}

std::optional<double> FrameMotion::misfit(const TimedFrame& frame, const JointsAt& joints_at, double dt_s) {
  if (!place(joints_at, frame.stamp - seconds(dt_s))) return std::nullopt;
  compare(frame);
  if (pixels_.size() < settings_.min_pixels) return std::nullopt;
  double sum = 0;
  for (const Pixel& pixel : pixels_) {
    const double off = pixel.residual / kMisfitReach_m;
    sum += std::min(off * off, 1.0);
  }
  return sum / static_cast<double>(pixels_.size());
}

std::optional<OffsetEquations> FrameMotion::observe(const TimedFrame& frame, const JointsAt& joints_at,
                                                    double dt_s) {
  const auto time = frame.stamp - seconds(dt_s);
  const auto before = joints_at(time - kSpeedReach), after = joints_at(time + kSpeedReach);
  if (!before || !after || !place(joints_at, time)) return std::nullopt;
  const auto& robot = cell_.robot();
  const LinkMotion motion(robot.forward_kinematics(*before), cell_.link_poses(),
                          robot.forward_kinematics(*after),
                          2 * std::chrono::duration<double>(kSpeedReach).count());
  compare(frame);
  std::vector<float> whitened;
  for (const Pixel& pixel : pixels_)
    if (std::abs(pixel.residual) < settings_.kernel_m)
      whitened.push_back(static_cast<float>(pixel.residual / kTypicalSigma_m));
  const double kernel = std::clamp(kKernelSigmas * kTypicalSigma_m * robust_sigma(std::move(whitened)),
                                   kMinKernel_m, settings_.kernel_m);
  OffsetSums sums(
      static_cast<std::size_t>((camera_.width / kBlockSide + 1) * (camera_.height / kBlockSide + 1)));
  const Eigen::Matrix3d R = frame.T_base_sensor.linear();
  for (const Pixel& pixel : pixels_) {
    const double weight = tukey_weight(pixel.residual, kernel);
    if (weight <= 0) continue;
    const Eigen::Vector3d ray = rays_[pixel.index];
    const Eigen::Vector3d n_base = R * prediction_.normal[pixel.index].cast<double>();
    const Eigen::Vector3d p_base = frame.T_base_sensor * (pixel.z * ray);
    // Along the ray a surface that moves by v goes n·v / (n·ray) farther; a sensor that moves does the
    // opposite. Later exposure than believed: the joints of an earlier moment are those of the frame.
    const double along = frame.correction.slope(pixel.z) / pixel.slope;
    OffsetVector jacobian;
    jacobian << -along * n_base.dot(motion.velocity(prediction_.link[pixel.index], p_base)),
        -along * p_base.cross(n_base), -along * n_base, 1;
    const double sigma = depth_sigma_m(pixel.z, -pixel.slope / ray.norm(), 1 / camera_.fx);
    sums.add(jacobian, pixel.residual + jacobian[0] * dt_s, pixel.residual, sigma, weight, pixel.cluster);
  }
  if (sums.count() < settings_.min_pixels) return std::nullopt;
  return sums.equations();
}

}  // namespace calibrd
