// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/used_pose.hpp"

namespace calibrd {

std::optional<UsedPose> pose_to_use(const LiveSensor& sensor, const std::optional<Pose>& guess) {
  const auto pose = sensor.pose();
  if (pose.known)
    return UsedPose{*pose.known->result.T_base_sensor, pose.known->result.depth_correction, pose.valid};
  if (guess) return UsedPose{*guess, {}, false};
  return std::nullopt;
}

}  // namespace calibrd
