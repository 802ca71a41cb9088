// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// The linear map (6 × joints) from joint zeros to the δ that makes a pose right for the joints *as
/// reported*: where the pose puts the robot's visible tip agrees best, over all views, with where the
/// reported joints put it. Other visible links count a little, so that a small tip does not decide the
/// rotation alone. `predictions` must be what the views' cells (zeros applied) show from `T_base_sensor`.
Eigen::Matrix<double, 6, kMaxJointZeros> reported_joints_map(std::span<const RegistrationView> views,
                                                             std::span<const VirtualMeasurement> predictions,
                                                             const CameraModel& camera,
                                                             const Pose& T_base_sensor);

}  // namespace calibrd
