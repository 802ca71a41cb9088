// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/obstacle_watch.hpp"

#include "api/problem/api_error.hpp"
#include "server/live_cell/sound_sighting.hpp"

namespace calibrd {

ObstacleFinder& ObstacleWatch::finder(const LiveSensor& sensor) {
  return finders_.try_emplace(sensor.id(), cell_, sensor.camera()).first->second;
}

api::SensorObstacles ObstacleWatch::look(const LiveSensor& sensor) {
  api::SensorObstacles seen;
  seen.sensor_id = sensor.id();
  // Before the pose: if another pose takes over meanwhile, its background is not known yet.
  const auto background = sensor.background();
  const auto sound = sound_sighting(sensor, true);
  if (!sound) {
    seen.code = api::problem_entry(static_cast<api::ApiError>(sound.error().code.value())).code;
    seen.reason = sound.error().message();
    return seen;
  }
  if (!background || sensor.background() != background) {
    seen.code = "background_not_known";
    seen.reason =
        "what this sensor sees of the cell itself is not known yet for this pose; it is learnt from the "
        "calibration's views, or while checks pass: let the robot hold still in view in two postures";
    return seen;
  }
  const View& view = sound->sighting->view;
  seen.stamp = sound->sighting->exposed;
  seen.joint_positions_rad = view.joint_positions_rad;
  seen.calibration_id = sound->known.calibration_id;
  seen.T_base_sensor = sound->known.result.T_base_sensor;
  const std::lock_guard lock(mutex_);
  seen.obstacles =
      finder(sensor).find(view, *background, *seen.T_base_sensor, sound->known.result.depth_correction);
  seen.age = Clock::now() - *seen.stamp;
  return seen;
}

}  // namespace calibrd
