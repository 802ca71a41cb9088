// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/robot/robot_model.hpp"

namespace calibrd {

struct WaySettings {
  double min_height_m = 0;  ///< no moving link below this (base frame, z up): the table
  double step_rad = 0.02;   ///< between the postures looked at on the way, of the joint that moves most
  double self_clearance_m = 0.03;  ///< as in PlanningSettings
};

/// What speaks against visiting `postures` one after the other from `from`, straight in joint space, as far
/// as the model alone can tell: limits of the joints, the table, the robot's own links. Nothing: no
/// objection. Obstacles in the cell are not known. Positions: RobotModel::position_names() order; `from`
/// itself may be near itself, but not below the table.
std::optional<std::string> way_objection(const RobotModel& robot, const std::vector<double>& from,
                                         std::span<const std::vector<double>> postures,
                                         const WaySettings& settings);

}  // namespace calibrd
