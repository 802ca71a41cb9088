// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/calibration/calibrate.hpp"

namespace calibrd {

struct ObservabilityLimits {
  double max_sigma_m = 0.003;    ///< of a shift of the robot as the sensor sees it, in any direction
  double max_sigma_rad = 0.003;  ///< of a rotation about any axis through the robot
};

/// The directions in which the covariance exceeds the limits, worst first, in plain words. They are taken at
/// the robot (`robot_middle_base`), where shift and rotation of the sensor come apart: a sensor that swings
/// about the robot by a degree moves by centimetres, yet sees the robot where it is.
std::vector<WeakDirection> weak_directions(const Matrix6d& covariance, const Pose& T_base_sensor,
                                           const Eigen::Vector3d& robot_middle_base,
                                           const ObservabilityLimits& limits);

/// Predicted error of a point of the workspace as the sensor sees it: δp = δω × (p - t) + δt.
std::vector<WorkspaceError> workspace_errors(const Matrix6d& covariance, const Pose& T_base_sensor,
                                             const std::vector<WorkspacePoint>& points);

}  // namespace calibrd
