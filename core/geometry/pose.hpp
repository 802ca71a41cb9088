// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// A rigid transform. Named `T_a_b`, it maps points in frame b to frame a: p_a = T_a_b * p_b. Metres.
using Pose = Eigen::Isometry3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rotation matrix of a rotation vector (axis times angle, rad).
Eigen::Matrix3d exp_so3(const Eigen::Vector3d& rotation_rad);

/// Rotation vector (axis times angle, rad; angle in [0, pi]) of a rotation matrix.
Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation);

/// `delta` = (δω, δt) about the sensor origin in base axes: R = Exp(δω) R̂, t = t̂ + δt.
/// This is the perturbation the covariance of a calibration speaks of.
Pose perturbed(const Pose& T_base_sensor, const Vector6d& delta);

/// The `delta` with perturbed(from, delta) == to.
Vector6d difference(const Pose& from, const Pose& to);

/// Takes a δ = (δω, δt) of axes b to axes a: δ_a = turn_of_axes(R_a_b) * δ_b.
Matrix6d turn_of_axes(const Eigen::Matrix3d& R_a_b);

/// Standard deviation in the direction that is known worst.
double worst_sigma(const Eigen::Matrix3d& covariance);

/// Turns `T_base_sensor` about the point `pivot_sensor` (m, sensor frame), then moves it by `shift_m` (base
/// axes).
Pose turned_about(const Pose& T_base_sensor, const Eigen::Vector3d& pivot_sensor,
                  const Eigen::Vector3d& rotation_rad, const Eigen::Vector3d& shift_m);

}  // namespace calibrd
