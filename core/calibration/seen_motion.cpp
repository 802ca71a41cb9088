// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/seen_motion.hpp"

#include "core/global/moving_points.hpp"
#include "core/global/point_groups.hpp"

namespace calibrd {

SeenMotion see_motion(std::span<const RegistrationView> views, const CameraModel& camera) {
  constexpr float kReach_m = 0.12F;        // as find_starts() groups them
  constexpr std::size_t kLeastPoints = 8;  // likewise
  SeenMotion motion;
  for (MovingPoints& moving : find_moving_points(views, camera, {})) {
    if (moving.points.size() >= kLeastPoints && !group_points(moving.points, kReach_m, kLeastPoints).empty())
      motion.forms_groups = true;
    motion.masks.push_back(std::move(moving.mask));
  }
  return motion;
}

std::vector<StartHypothesis> starts_from(const SeenMotion& motion, std::span<const RegistrationView> views,
                                         const CameraModel& camera, const StartSettings& settings) {
  if (!motion.forms_groups) return {};
  return find_starts(views, camera, settings);
}

}  // namespace calibrd
