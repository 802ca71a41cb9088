// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/reported_joints.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace calibrd {
namespace {

constexpr double kOtherLinksWeight = 0.02;
constexpr int kStride = 4;

/// The visible link furthest down the chain: links are ordered parents before children.
int visible_tip(std::span<const VirtualMeasurement> predictions) {
  std::int16_t tip = -1;
  for (const VirtualMeasurement& prediction : predictions)
    tip = std::max(tip, std::ranges::max(prediction.link));
  return tip;
}

}  // namespace

Eigen::Matrix<double, 6, kMaxJointZeros> reported_joints_map(std::span<const RegistrationView> views,
                                                             std::span<const VirtualMeasurement> predictions,
                                                             const CameraModel& camera,
                                                             const Pose& T_base_sensor) {
  const int tip = visible_tip(predictions);
  Matrix6d information = Matrix6d::Zero();
  Eigen::Matrix<double, 6, kMaxJointZeros> pull = Eigen::Matrix<double, 6, kMaxJointZeros>::Zero();
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (int y = 0; y < camera.height; y += kStride) {
      for (int x = 0; x < camera.width; x += kStride) {
        const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                              static_cast<std::size_t>(x);
        const int link = predictions[v].link[i];
        if (link < 0) continue;
        const Eigen::Vector3d p_base = T_base_sensor * (predictions[v].depth_m[i] * views[v].rays->at(x, y));
        // δ moves the point by δω×u + δt; it shall undo what the zeros did to it.
        const Eigen::Vector3d u = p_base - T_base_sensor.translation();
        Eigen::Matrix<double, 3, 6> by_pose;
        by_pose << 0, u.z(), -u.y(), 1, 0, 0, -u.z(), 0, u.x(), 0, 1, 0, u.y(), -u.x(), 0, 0, 0, 1;
        const double weight = link == tip ? 1.0 : kOtherLinksWeight;
        information.noalias() += weight * by_pose.transpose() * by_pose;
        pull.noalias() -= weight * by_pose.transpose() * views[v].axes.derivative(link, p_base);
      }
    }
  }
  information.diagonal().array() += 1e-9 * information.diagonal().maxCoeff() + 1e-12;
  return information.ldlt().solve(pull);
}

}  // namespace calibrd
