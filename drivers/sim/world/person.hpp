// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "drivers/sim/world/mesh.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// A walking person of 1.75 m, put together of capsules: torso, head, two legs, two arms.
std::vector<Mesh> person_parts();

/// T_base_part of each of person_parts() at a time of CLOCK_MONOTONIC.
std::vector<Eigen::Isometry3d> person_poses(const PersonState& person, std::int64_t now_ns);

}  // namespace calibrd::sim
