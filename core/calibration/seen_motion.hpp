// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/global/find_start.hpp"

namespace calibrd {

/// What moved between the views, and whether a start can be looked for in it.
struct SeenMotion {
  std::vector<std::vector<std::uint8_t>> masks;  ///< per view, per pixel, 1 = moved
  bool forms_groups = false;                     ///< some of it hangs together: scattered points are no robot
};

SeenMotion see_motion(std::span<const RegistrationView> views, const CameraModel& camera);

/// find_starts(), which needs points that form groups; empty when they form none.
std::vector<StartHypothesis> starts_from(const SeenMotion& motion, std::span<const RegistrationView> views,
                                         const CameraModel& camera, const StartSettings& settings);

}  // namespace calibrd
