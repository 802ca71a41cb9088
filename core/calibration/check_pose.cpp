// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/check_pose.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr std::size_t kMinPixels = 500;
constexpr double kTolerance_m = 0.02;  // an order above the noise of the sensors we know
constexpr double kMinAgreement = 0.6;
constexpr float kMinCosine = 0.3F;

}  // namespace

PoseCheck check_pose(VirtualCell& cell, const CameraModel& camera, const View& view,
                     const Pose& T_base_sensor, const DepthCorrection& correction) {
  cell.set_joints(view.joint_positions_rad);
  VirtualMeasurement prediction;
  cell.measure(camera, T_base_sensor, prediction);
  std::vector<double> residuals;
  for (int y = 0; y < camera.height; y += 2) {
    for (int x = 0; x < camera.width; x += 2) {
      const std::size_t i = view.depth.index(x, y);
      if (prediction.link[i] < 0 || view.depth.raw[i] == 0) continue;
      const Eigen::Vector3f d = camera.ray(x, y).cast<float>();
      if (-prediction.normal[i].dot(d) < kMinCosine * d.norm()) continue;
      residuals.push_back(view.depth.depth_m(x, y) - correction.measured(prediction.depth_m[i]));
    }
  }
  PoseCheck check;
  check.robot_pixels = residuals.size();
  if (residuals.size() < kMinPixels) return check;
  check.enough_evidence = true;
  const auto within = std::ranges::count_if(residuals, [](double r) { return std::abs(r) < kTolerance_m; });
  check.agreement = static_cast<double>(within) / static_cast<double>(residuals.size());
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  check.median_residual_m = *middle;
  check.agrees = check.agreement >= kMinAgreement;
  return check;
}

}  // namespace calibrd
