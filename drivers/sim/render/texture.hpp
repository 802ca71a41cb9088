// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace calibrd::sim {

/// Smooth mottling in -1..1 of a point on a body (body frame, m): value noise on a lattice of 4 cm, so that it
/// sticks to the body when the body moves.
float mottling(const Eigen::Vector3f& point_body, std::uint32_t seed);

}  // namespace calibrd::sim
