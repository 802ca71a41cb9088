// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// The pose that something is shown with, valid or not, and what is known of the depth's bias.
struct UsedPose {
  Pose T_base_sensor;
  DepthCorrection correction;
  bool valid = false;
};

/// The sensor's last known pose, else `guess`; nothing where there is neither.
std::optional<UsedPose> pose_to_use(const LiveSensor& sensor, const std::optional<Pose>& guess);

}  // namespace calibrd
