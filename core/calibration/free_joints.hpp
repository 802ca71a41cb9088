// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/registration_view.hpp"

namespace calibrd {

struct FreeJointsFit {
  Pose T_base_sensor = Pose::Identity();
  double spread_rad = 0;   ///< largest standard deviation of one joint's correction over the views
  double largest_rad = 0;  ///< largest correction
  /// Share of the robot's measured pixels that lie where they should, before and after.
  double agreeing_before = 0, agreeing_after = 0;
};

/// Fits the sensor's pose and, in every view for itself, the joints: what a robot that moved while it was
/// seen needs. Leaves the views at the joints found. For finding out what is wrong, not for a calibration.
FreeJointsFit fit_free_joints(std::span<RegistrationView> views, const CameraModel& camera,
                              const Pose& start);

}  // namespace calibrd
