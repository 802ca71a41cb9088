// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// A mesh where it stands.
struct Body {
  const Mesh* mesh = nullptr;
  Surface surface;
  Eigen::Isometry3d T_base_body = Eigen::Isometry3d::Identity();
  bool is_robot = false;  ///< of the robot that follows the joints
};

/// What stands still as long as nobody moves it: the objects and the other robot. `cell` must outlive the result.
std::vector<Body> standing_bodies(const Cell& cell, const WorldState& state);

/// What moves by itself: the robot, at its true joints, and the person. `cell` and `person` (person_parts()) must
/// outlive the result.
std::vector<Body> moving_bodies(const Cell& cell, const std::vector<Mesh>& person, const WorldState& state,
                                std::int64_t now_ns);

}  // namespace calibrd::sim
