// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace calibrd {

Eigen::Matrix3d exp_so3(const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle < 1e-12) {
    Eigen::Matrix3d small;
    small << 1, -rotation_rad.z(), rotation_rad.y(), rotation_rad.z(), 1, -rotation_rad.x(),
        -rotation_rad.y(), rotation_rad.x(), 1;
    return small;
  }
  return Eigen::AngleAxisd(angle, rotation_rad / angle).toRotationMatrix();
}

Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec() * (q.w() < 0 ? -1.0 : 1.0);
  // atan2 of the quaternion parts stays exact near 0 and near pi, where acos of the trace does not.
  const double half = std::atan2(q.w() < 0 ? -sine : sine, std::abs(q.w()));
  return 2.0 * half / sine * q.vec();
}

Pose perturbed(const Pose& T_base_sensor, const Vector6d& delta) {
  Pose moved = T_base_sensor;
  moved.linear() = exp_so3(delta.head<3>()) * T_base_sensor.linear();
  moved.translation() += delta.tail<3>();
  return moved;
}

Vector6d difference(const Pose& from, const Pose& to) {
  Vector6d delta;
  delta << log_so3(to.linear() * from.linear().transpose()), to.translation() - from.translation();
  return delta;
}

Matrix6d turn_of_axes(const Eigen::Matrix3d& R_a_b) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R_a_b;
  return turn;
}

double worst_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
                       .eigenvalues()
                       .maxCoeff());
}

Pose turned_about(const Pose& T_base_sensor, const Eigen::Vector3d& pivot_sensor,
                  const Eigen::Vector3d& rotation_rad, const Eigen::Vector3d& shift_m) {
  const Eigen::Vector3d pivot_base = T_base_sensor * pivot_sensor;
  Pose moved;
  moved.linear() = exp_so3(rotation_rad) * T_base_sensor.linear();
  moved.translation() = pivot_base - moved.linear() * pivot_sensor + shift_m;
  return moved;
}

}  // namespace calibrd
