// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// The newest frame; nothing when it is too old to be what the sensor sees now.
std::shared_ptr<const Sighting> fresh_sighting(const LiveSensor& sensor);

/// A frame of now and the valid pose it was seen from.
struct SoundSighting {
  std::shared_ptr<const Sighting> sighting;
  api::PoseReport::Known known;  ///< with T_base_sensor
};

/// Errors: ApiError::pose_not_valid, no_frame; joints_stale where `needs_joints` and those of the frame's
/// time are not known, or where they leave a moving robot uncertain by centimetres.
Result<SoundSighting> sound_sighting(const LiveSensor& sensor, bool needs_joints);

}  // namespace calibrd
