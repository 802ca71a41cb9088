// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

namespace calibrd {

struct PlanningSettings {
  std::size_t candidates = 200;  ///< postures that are looked at with the virtual sensor, at most
  std::size_t draws = 2000;      ///< random postures drawn to find them, at most
  std::uint64_t seed = 1;        ///< the same seed suggests the same posture
  double min_height_m = 0;       ///< no moving link below this (base frame, z up): the table
  std::optional<Eigen::AlignedBox3d> workspace_base;  ///< no moving link outside, m
  double limit_margin = 0.05;                         ///< kept from the ends of the joints' ranges, rad or m
  /// Links that are not neighbours stay this far apart, or half as far as the robot was seen to hold them.
  double self_clearance_m = 0.03;
  double min_change_rad = 0.17;    ///< some joint differs this much from every posture seen
  double min_range_m = 0.5;        ///< no moving link nearer to the sensor
  double max_range_m = 4.5;        ///< what lies further away is not measured
  double min_robot_share = 0.012;  ///< of the picture must show the robot, measurably
};

}  // namespace calibrd
