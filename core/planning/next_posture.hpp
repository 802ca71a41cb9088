// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planning/planning_settings.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// Where to move the robot next, and what it brings.
struct PostureSuggestion {
  std::vector<std::string> joint_names;
  std::vector<double> positions_rad;  ///< of joint_names; prismatic: m
  double sigma_position_m = 0;        ///< expected once a view of it is added; as in CalibrationResult
  double sigma_rotation_rad = 0;
  std::size_t robot_pixels = 0;  ///< that the sensor is expected to see
  std::string improves;          ///< what is weakest now, and what becomes of it
};

/// The posture that helps most to know where a sensor is: of random postures that the joints' limits, the
/// table, the robot's own links and the sensor's range allow, the one after which the pose's covariance is
/// expected to be smallest (a radian counting as a metre, as in the verdict). It knows nothing of obstacles
/// in the cell, nor of the way there.
/// covariance: of the pose, see perturbed(). seen_postures: those it was found from, position_names() order.
/// Nothing: no posture drawn is allowed and in view.
std::optional<PostureSuggestion> suggest_posture(const VirtualCell& cell, const CameraModel& camera,
                                                 const Pose& T_base_sensor, const Matrix6d& covariance,
                                                 std::span<const std::vector<double>> seen_postures,
                                                 const PlanningSettings& settings);

}  // namespace calibrd
