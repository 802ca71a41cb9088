// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/robot/robot_model.hpp"

namespace calibrd {

/// A point on the surface of a robot's CAD model.
struct SurfaceSample {
  Eigen::Vector3d point;   ///< base frame, m
  Eigen::Vector3d normal;  ///< unit, base frame, as the mesh winds
  int link = -1;
};

/// `count` points spread uniformly by area over all link surfaces, robot at `positions` (the paper's section
/// IV.B: uniform sampling of the CAD data). The same seed gives the same points. Empty for a robot without
/// surfaces.
std::vector<SurfaceSample> sample_surface(const RobotModel& robot, std::span<const double> positions,
                                          std::size_t count, std::uint64_t seed);

}  // namespace calibrd
