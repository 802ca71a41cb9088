// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

/// How the perturbation moves a point of the base frame that the sensor sees: 3×6.
Eigen::Matrix<double, 3, 6> point_jacobian(const Eigen::Vector3d& p_base, const Pose& T_base_sensor) {
  const Eigen::Vector3d u = p_base - T_base_sensor.translation();
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << 0, u.z(), -u.y(), 1, 0, 0, -u.z(), 0, u.x(), 0, 1, 0, u.y(), -u.x(), 0, 0, 0, 1;
  return jacobian;
}

struct NamedAxis {
  Eigen::Vector3d direction_base;
  const char* shift;
  const char* rotation;
};

/// The name of the axis that lies nearest.
std::string name_of(const Eigen::Vector3d& direction, bool is_rotation, const Pose& T_base_sensor,
                    const Eigen::Vector3d& robot_middle_base) {
  const Eigen::Vector3d sight = (robot_middle_base - T_base_sensor.translation()).normalized();
  const Eigen::Vector3d right = T_base_sensor.linear().col(0), down = T_base_sensor.linear().col(1);
  const NamedAxis axes[] = {
      {sight, "along the line of sight", "about the line of sight"},
      {Eigen::Vector3d::UnitZ(), "along the vertical axis of the robot",
       "about the vertical axis of the robot"},
      {right, "across the line of sight, to the image's side", "about the horizontal axis of the image"},
      {down, "across the line of sight, up and down the image", "about the upright axis of the image"}};
  const auto nearest = std::ranges::max_element(
      axes, {}, [&](const NamedAxis& axis) { return std::abs(axis.direction_base.dot(direction)); });
  return is_rotation ? nearest->rotation : nearest->shift;
}

void add_weak(const Eigen::Matrix3d& covariance, bool is_rotation, double limit, const Pose& T_base_sensor,
              const Eigen::Vector3d& robot_middle_base, std::vector<WeakDirection>& weak) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  for (Eigen::Index i = 2; i >= 0; --i) {
    const double sigma = std::sqrt(std::max(0.0, solver.eigenvalues()[i]));
    if (sigma <= limit) return;
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    weak.push_back(
        {name_of(direction, is_rotation, T_base_sensor, robot_middle_base), is_rotation, direction, sigma});
  }
}

}  // namespace

std::vector<WeakDirection> weak_directions(const Matrix6d& covariance, const Pose& T_base_sensor,
                                           const Eigen::Vector3d& robot_middle_base,
                                           const ObservabilityLimits& limits) {
  const auto at_robot = point_jacobian(robot_middle_base, T_base_sensor);
  std::vector<WeakDirection> weak;
  add_weak(at_robot * covariance * at_robot.transpose(), false, limits.max_sigma_m, T_base_sensor,
           robot_middle_base, weak);
  add_weak(covariance.topLeftCorner<3, 3>(), true, limits.max_sigma_rad, T_base_sensor, robot_middle_base,
           weak);
  const auto excess = [&](const WeakDirection& d) {
    return d.sigma / (d.is_rotation ? limits.max_sigma_rad : limits.max_sigma_m);
  };
  std::ranges::stable_sort(weak, std::greater<>{}, excess);
  return weak;
}

std::vector<WorkspaceError> workspace_errors(const Matrix6d& covariance, const Pose& T_base_sensor,
                                             const std::vector<WorkspacePoint>& points) {
  std::vector<WorkspaceError> errors;
  for (const WorkspacePoint& point : points) {
    const auto jacobian = point_jacobian(point.p_base, T_base_sensor);
    errors.push_back({point, std::sqrt((jacobian * covariance * jacobian.transpose()).trace())});
  }
  return errors;
}

}  // namespace calibrd
