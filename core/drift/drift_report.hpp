// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/drift/drift_verdict.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// One look at the watch.
struct DriftReport {
  DriftVerdict verdict = DriftVerdict::no_evidence;
  bool has_background = false;
  double statistic = 0, threshold = 0;  ///< of the test for a moved sensor
  double turn_rad = 0, shift_m = 0;     ///< mean over some frames; the shift is that of what the sensor sees
  double turn_sigma_rad = 0, shift_sigma_m = 0;        ///< of one frame
  double depth_offset_change_m = 0;                    ///< mean over a second
  double same = 0, nearer = 0, farther = 0, dark = 0;  ///< shares of the background in view
  std::optional<Pose>
      T_base_sensor_seen;  ///< where the background says the sensor is; only once it has moved
  double seen_turn_sigma_rad = 0, seen_shift_sigma_m = 0;  ///< of that, about the middle of the background
};

}  // namespace calibrd
