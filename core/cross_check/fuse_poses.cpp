// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cross_check/fuse_poses.hpp"

#include <Eigen/Cholesky>

#include "core/calibration/check_pose.hpp"

namespace calibrd {

FusedPoses fuse_poses(const CheckedSensor& first, const CheckedSensor& second, const CrossCheck& check) {
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  Matrix12d covariance = Matrix12d::Zero();
  covariance.topLeftCorner<6, 6>() = first.covariance;
  covariance.bottomRightCorner<6, 6>() = second.covariance;
  Eigen::Matrix<double, 6, 12> relative;
  relative << -shift_of_point(check.middle_base - first.T_base_sensor.translation()),
      shift_of_point(check.middle_base - second.T_base_sensor.translation());
  const Matrix6d innovation = relative * covariance * relative.transpose() + check.covariance;
  const Eigen::Matrix<double, 12, 6> gain = innovation.ldlt().solve(relative * covariance).transpose();
  const Vector12d delta = gain * check.turn_shift;
  const Matrix12d left = covariance - gain * relative * covariance;
  return {perturbed(first.T_base_sensor, delta.head<6>()), perturbed(second.T_base_sensor, delta.tail<6>()),
          left.topLeftCorner<6, 6>(), left.bottomRightCorner<6, 6>()};
}

}  // namespace calibrd
