// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/check_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr std::size_t kMinPixels = 500;
constexpr double kWithin_m = 0.02;  // an order above the noise of the sensors we know
constexpr double kMinAgreement = 0.6;
constexpr float kMinCosine = 0.3F;

// One posture of a robot whose joint zeros are 0.05° off looks displaced by about this much though the sensor
// stands still.
constexpr double kModelShift_m = 0.001;
constexpr double kModelTurn_rad = 0.0012;
/// Calibrated captures, joint zeros off by up to 1 mrad among them, stay below 2.2 view by view; a sensor
/// moved by 5 mm reaches 4 to 5, by 10 mm 8 to 10.
constexpr double kMaxShiftSigmas = 4;
/// Something this much in front of the robot hides it, and says nothing about the sensor's pose.
constexpr double kInFront_m = 0.05;
/// Share of the robot: beyond the first what lies at the rim is left out, beyond the second nothing speaks
/// against the pose.
constexpr double kRimHidden = 0.1, kMostHidden = 0.5;
constexpr int kRim_px = 8;

}  // namespace

Matrix6d shift_of_point(const Eigen::Vector3d& lever) {
  Matrix6d move = Matrix6d::Identity();
  move.bottomLeftCorner<3, 3>() << 0, lever.z(), -lever.y(), -lever.z(), 0, lever.x(), lever.y(), -lever.x(),
      0;
  return move;
}

PoseChecker::PoseChecker(const VirtualCell& cell, const CameraModel& camera)
    : camera_(camera), cell_(cell), tracker_(cell, camera) {}

Eigen::Vector3d PoseChecker::compare(const View& view, const Pose& T_base_sensor,
                                     const DepthCorrection& correction, PoseCheck& check) {
  cell_.set_joints(view.joint_positions_rad);
  cell_.measure(camera_, T_base_sensor, prediction_);
  std::vector<double> residuals;
  hidden_.clear();
  Eigen::Vector3d middle_sensor = Eigen::Vector3d::Zero();
  for (int y = 0; y < camera_.height; y += 2) {
    for (int x = 0; x < camera_.width; x += 2) {
      const std::size_t i = view.depth.index(x, y);
      if (prediction_.link[i] < 0 || view.depth.raw[i] == 0) continue;
      const Eigen::Vector3d d = camera_.ray(x, y);
      if (-prediction_.normal[i].cast<double>().dot(d) < kMinCosine * d.norm()) continue;
      const double residual = view.depth.depth_m(x, y) - correction.measured(prediction_.depth_m[i]);
      if (residual < -kInFront_m) {
        ++check.hidden_pixels;
        hidden_.push_back({x, y});
        continue;
      }
      residuals.push_back(residual);
      middle_sensor += prediction_.depth_m[i] * d;
    }
  }
  check.robot_pixels = residuals.size();
  if (residuals.empty()) return T_base_sensor.translation();
  const auto within = std::ranges::count_if(residuals, [](double r) { return std::abs(r) < kWithin_m; });
  check.agreement = static_cast<double>(within) / static_cast<double>(residuals.size());
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  check.median_residual_m = *middle;
  return T_base_sensor * (middle_sensor / static_cast<double>(residuals.size()));
}

PoseCheck PoseChecker::check(const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
                             const Matrix6d& pose_covariance) {
  PoseCheck check;
  const Eigen::Vector3d middle_base = compare(view, T_base_sensor, correction, check);
  if (check.robot_pixels < kMinPixels) return check;
  const double hidden = static_cast<double>(check.hidden_pixels) /
                        static_cast<double>(check.hidden_pixels + check.robot_pixels);
  check.enough_evidence = hidden <= kMostHidden;
  if (check.agreement < kMinAgreement) return check;
  const auto tracked =
      tracker_.update(hidden > kRimHidden ? without_rim(view) : view, T_base_sensor, correction);
  if (!tracked) {  // too few pixels agree to within centimetres: the pose does not explain them, ...
    if (hidden > kRimHidden) check.enough_evidence = false;  // ... or a fence leaves nothing but rims
    return check;
  }
  const Matrix6d move = shift_of_point(middle_base - T_base_sensor.translation());
  const Vector6d shift = move * tracked->innovation;
  // A sensor whose residuals scatter more than noise explains is wrong by whole patches, too.
  const double scatter = std::max(1.0, tracked->sigma_factor);
  Vector6d allowed;
  allowed << Eigen::Vector3d::Constant(kModelTurn_rad * kModelTurn_rad),
      Eigen::Vector3d::Constant(kModelShift_m * kModelShift_m);
  check.pose_covariance = move * pose_covariance * move.transpose();
  Matrix6d covariance = move * tracked->covariance * move.transpose() + check.pose_covariance;
  covariance.diagonal() += scatter * scatter * allowed;
  check.turn_shift = shift;
  check.turn_shift_covariance = covariance;
  check.middle_base = middle_base;
  check.turn_rad = shift.head<3>().norm();
  check.shift_m = shift.tail<3>().norm();
  check.shift_sigmas = std::sqrt(shift.dot(covariance.ldlt().solve(shift)));
  check.agrees = check.shift_sigmas < kMaxShiftSigmas;  // false when it is not a number
  if (check.agrees) check.enough_evidence = true;
  return check;
}

/// At the rim of what hides part of the robot depths are of neither, or of both.
View PoseChecker::without_rim(const View& view) const {
  View rest = view;
  for (const auto& [x, y] : hidden_) {
    const int left = std::max(0, x - kRim_px), right = std::min(camera_.width - 1, x + kRim_px);
    for (int v = std::max(0, y - kRim_px); v <= std::min(camera_.height - 1, y + kRim_px); ++v)
      std::fill_n(rest.depth.raw.begin() + static_cast<std::ptrdiff_t>(rest.depth.index(left, v)),
                  right - left + 1, std::uint16_t{0});
  }
  return rest;
}

}  // namespace calibrd
