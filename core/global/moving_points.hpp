// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/registration/registration_view.hpp"

namespace calibrd {

struct MovingSettings {
  double min_step_m = 0.04;      ///< what moved lies this far in front of what another view sees there ...
  double min_step_per_m = 0.02;  ///< ... and this much times its squared depth: stereo's noise grows so
  double voxel_m = 0.05;         ///< one point is kept per cube of this side
};

/// Per pixel, row-major: 1 = it shows what moved.
using PixelMask = std::vector<std::uint8_t>;

/// What of one view is not there in other views: the robot, what it carries, and what else moves.
struct MovingPoints {
  std::vector<Eigen::Vector3f> points;  ///< sensor frame, m, thinned evenly
  PixelMask mask;                       ///< empty where nothing is known to have moved
};

/// Finds what moved between the views by comparing each pixel with the same pixel of the other views: the
/// sensor stands still, so what a nearer surface hides in one view and shows in another has moved. A large
/// area without any measurement counts as far away: open space, beyond the sensor's range. Needs neither a
/// model nor a mask. Two views or more; fewer give nothing.
std::vector<MovingPoints> find_moving_points(std::span<const RegistrationView> views,
                                             const CameraModel& camera, const MovingSettings& settings);

/// Where the robot may be: what moved between the views, or, in a single one, all that is near; then the mask
/// is empty.
std::vector<MovingPoints> robot_candidates(std::span<const RegistrationView> views,
                                           const CameraModel& camera);

}  // namespace calibrd
