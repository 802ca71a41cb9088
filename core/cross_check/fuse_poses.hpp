// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/cross_check/cross_check.hpp"

namespace calibrd {

/// Both poses with what the clouds say of how they lie to each other: each pulls on the other by how much
/// better it is known (Kalman update of the twelve degrees of freedom). Measured (docs/sensors.md), this
/// hardly makes two good poses better: the daemon only compares.
struct FusedPoses {
  Pose first_T_base_sensor, second_T_base_sensor;
  Matrix6d first_covariance, second_covariance;  ///< see perturbed()
};

/// `check`: cross_check() of the two, which must have overlap and not disagree.
FusedPoses fuse_poses(const CheckedSensor& first, const CheckedSensor& second, const CrossCheck& check);

}  // namespace calibrd
