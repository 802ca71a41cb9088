// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/sound_sighting.hpp"

#include "api/problem/api_error.hpp"

namespace calibrd {
namespace {

/// A frame older than this is not what the sensor sees now.
constexpr auto kFreshFrame = std::chrono::seconds(1);

}  // namespace

std::shared_ptr<const Sighting> fresh_sighting(const LiveSensor& sensor) {
  auto sighting = sensor.newest();
  return sighting && Clock::now() - sighting->stamp <= kFreshFrame ? sighting : nullptr;
}

Result<SoundSighting> sound_sighting(const LiveSensor& sensor, bool needs_joints) {
  auto pose = sensor.pose();
  if (!pose.valid || !pose.known || !pose.known->result.T_base_sensor)
    return fail(api::ApiError::pose_not_valid, sensor.id() + ": " + pose.reason);
  auto sighting = fresh_sighting(sensor);
  if (!sighting) return fail(api::ApiError::no_frame, sensor.id() + ": " + sensor.hindrance());
  if (needs_joints && sighting->view.joint_positions_rad.empty())
    return fail(api::ApiError::joints_stale, sensor.id() + ": at the time of the newest frame");
  return SoundSighting{std::move(sighting), *std::move(pose.known)};
}

}  // namespace calibrd
