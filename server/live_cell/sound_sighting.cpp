// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/sound_sighting.hpp"

#include "api/problem/api_error.hpp"

namespace calibrd {
namespace {

/// A frame older than this is not what the sensor sees now.
constexpr auto kFreshFrame = std::chrono::seconds(1);
/// Three times as much is what is taken for the robot around where its joints put it.
constexpr double kMostTimingError_m = 0.007;

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
  if (needs_joints && sighting->timing_error_m.value_or(1) > kMostTimingError_m)
    return fail(api::ApiError::joints_stale,
                sensor.id() + ": the robot moves, and the time offset between its joints and the frames is " +
                    (sighting->timing_error_m ? "not known well enough for its speed" : "not known (yet)"));
  return SoundSighting{std::move(sighting), *std::move(pose.known)};
}

}  // namespace calibrd
