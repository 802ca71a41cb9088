// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/cloud_merger.hpp"

#include "api/problem/api_error.hpp"
#include "server/live_cell/sound_sighting.hpp"

namespace calibrd {
namespace {

/// A point so near the robot's surface is taken for robot.
constexpr double kOnRobot_m = 0.02;

}  // namespace

Result<api::MergedCloud> CloudMerger::merge(std::span<const LiveSensor* const> sensors,
                                            const api::MergedCloudRequest& request) {
  const std::lock_guard lock(mutex_);
  api::MergedCloud cloud;
  cloud.base_frame = cell_.robot().base_link();
  std::optional<Error> first;
  for (const LiveSensor* sensor : sensors) {
    const auto sound = sound_sighting(*sensor, !request.with_robot);
    if (sound) {
      cloud.parts.push_back(add(*sensor, *sound->sighting, sound->known, request.with_robot, cloud.points));
      continue;
    }
    const Error& error = sound.error();
    if (!first) first = error;
    cloud.left_out.push_back({sensor->id(),
                              api::problem_entry(static_cast<api::ApiError>(error.code.value())).code,
                              error.message()});
  }
  if (cloud.parts.empty() && first) return *first;
  return cloud;
}

api::MergedCloud::Part CloudMerger::add(const LiveSensor& sensor, const Sighting& sighting,
                                        const api::PoseReport::Known& known, bool with_robot,
                                        std::vector<Eigen::Vector3f>& points) {
  const Pose& T_base_sensor = *known.result.T_base_sensor;
  const DepthCorrection& correction = known.result.depth_correction;
  const DepthImage& depth = sighting.view.depth;
  const auto rays = cell_.pixel_rays(sensor.camera());
  if (!with_robot) cell_.set_joints(sighting.view.joint_positions_rad);
  const std::size_t before = points.size();
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const double measured_m = depth.depth_m(x, y);
      if (measured_m <= 0) continue;
      const Eigen::Vector3d p = T_base_sensor * (correction.truth(measured_m) * rays->at(x, y));
      if (with_robot || !cell_.nearest_surface(p, kOnRobot_m)) points.push_back(p.cast<float>());
    }
  return {sensor.id(),
          known.calibration_id,
          T_base_sensor,
          sighting.exposed,
          sighting.view.joint_positions_rad,
          points.size() - before};
}

}  // namespace calibrd
