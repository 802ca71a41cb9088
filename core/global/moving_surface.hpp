// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Points spread evenly over those links of the robot that move between the views.
struct PosedSurface {
  std::vector<Eigen::Vector3f> points;   ///< base frame, m
  std::vector<Eigen::Vector3f> normals;  ///< base frame, unit
};

/// The same `count` points of the moving links at the joints of each view. Empty surfaces when nothing moves
/// by 3 cm. Deterministic.
std::vector<PosedSurface> sample_moving_surface(std::span<const RegistrationView> views, std::size_t count);

}  // namespace calibrd
