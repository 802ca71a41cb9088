// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace calibrd {

/// What the frames say of a sensor's pose. Kept apart because each calls for something else.
enum class DriftVerdict {
  in_place,
  sensor_moved,        ///< the pose is wrong: calibrate again
  something_in_front,  ///< a person, a part: it passes
  scene_changed,       ///< a box moved, a door opened; the sensor stands
  robot_model_wrong,   ///< the background is in place, the robot is not: joint zero, base, model
  depth_bias_changed,  ///< the range reads more or less than at calibration (warm-up)
  no_evidence          ///< neither background nor robot in view, or the sensor is dark
};
inline constexpr std::size_t kDriftVerdicts = 7;

/// Stable name for programs: "in_place", "sensor_moved", …
const char* name_of(DriftVerdict verdict);
/// What it means and what to do.
const char* text_of(DriftVerdict verdict);

}  // namespace calibrd
