// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/cloud_maker.hpp"

#include "api/problem/api_error.hpp"
#include "server/live_cell/sound_sighting.hpp"
#include "server/live_cell/used_pose.hpp"

namespace calibrd {
namespace {

using api::ApiError;
using api::Cloud;

std::int64_t nanoseconds(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

Eigen::Vector3f point_at(const PixelRays& rays, int x, int y, double depth_m) {
  return (rays.at(x, y) * depth_m).cast<float>();
}

void move_to_base(Cloud& cloud, const Pose& T_base_sensor, const std::string& base_frame) {
  cloud.frame = base_frame;
  for (auto& point : cloud.points) point = (T_base_sensor * point.cast<double>()).cast<float>();
}

}  // namespace

Result<Cloud> CloudMaker::make(const api::CloudRequest& request, const LiveSensor& sensor,
                               const std::optional<Pose>& guess) {
  const std::lock_guard lock(mutex_);
  const auto pose = pose_to_use(sensor, guess);
  const bool needs_pose = request.kind != api::CloudKind::measured || request.in_base_frame;
  if (!pose && needs_pose) return fail(ApiError::no_pose, sensor.id());
  auto cloud = request.kind == api::CloudKind::measured ? measured(sensor)
               : request.kind == api::CloudKind::virtual_
                   ? virtual_cloud(sensor, pose->T_base_sensor)
                   : residual(sensor, pose->T_base_sensor, pose->correction);
  if (!cloud) return cloud;
  cloud->frame = sensor.pose().sensor_frame;
  if (pose && needs_pose) {
    cloud->T_base_sensor = pose->T_base_sensor;
    cloud->pose_valid = pose->valid;
  }
  if (request.in_base_frame) move_to_base(*cloud, pose->T_base_sensor, robot_.model().base_link());
  return cloud;
}

Result<Cloud> CloudMaker::measured(const LiveSensor& sensor) const {
  const auto sighting = fresh_sighting(sensor);
  if (!sighting) return fail(ApiError::no_frame, sensor.id());
  Cloud cloud;
  cloud.frame_stamp_ns = nanoseconds(sighting->exposed);
  const auto& depth = sighting->view.depth;
  const auto rays = cell_.pixel_rays(sensor.camera());
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (depth.raw[depth.index(x, y)] != 0)
        cloud.points.push_back(point_at(*rays, x, y, depth.depth_m(x, y)));
  return cloud;
}

Result<Cloud> CloudMaker::virtual_cloud(const LiveSensor& sensor, const Pose& T_base_sensor) {
  const auto joints = robot_.newest_joints();
  if (!joints) return fail(ApiError::no_joints);
  if (robot_.is_stale(*joints)) return fail(ApiError::joints_stale);
  const auto& camera = sensor.camera();
  measure(camera, joints->positions_rad, T_base_sensor);
  Cloud cloud;
  cloud.joint_stamp_ns = nanoseconds(joints->stamp);
  cloud.joint_positions_rad = joints->positions_rad;
  const auto rays = cell_.pixel_rays(camera);
  std::size_t pixel = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x, ++pixel)
      if (measurement_.link[pixel] >= 0)
        cloud.points.push_back(point_at(*rays, x, y, measurement_.depth_m[pixel]));
  return cloud;
}

Result<Cloud> CloudMaker::residual(const LiveSensor& sensor, const Pose& T_base_sensor,
                                   const DepthCorrection& correction) {
  const auto sighting = fresh_sighting(sensor);
  if (!sighting) return fail(ApiError::no_frame, sensor.id());
  const auto& view = sighting->view;
  if (view.joint_positions_rad.empty())
    return fail(ApiError::joints_stale, "at the time of the newest frame");
  const auto& camera = sensor.camera();
  measure(camera, view.joint_positions_rad, T_base_sensor);
  Cloud cloud;
  cloud.frame_stamp_ns = nanoseconds(sighting->exposed);
  cloud.joint_stamp_ns = cloud.frame_stamp_ns;  // interpolated at the frame's time
  cloud.joint_positions_rad = view.joint_positions_rad;
  const auto rays = cell_.pixel_rays(camera);
  std::size_t pixel = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x, ++pixel) {
      if (measurement_.link[pixel] < 0 || view.depth.raw[pixel] == 0) continue;
      const double depth_m = view.depth.depth_m(x, y);
      cloud.points.push_back(point_at(*rays, x, y, depth_m));
      cloud.residual_m.push_back(
          static_cast<float>(depth_m - correction.measured(measurement_.depth_m[pixel])));
    }
  return cloud;
}

void CloudMaker::measure(const CameraModel& camera, const std::vector<double>& positions,
                         const Pose& T_base_sensor) {
  cell_.set_joints(positions);
  cell_.measure(camera, T_base_sensor, measurement_);
}

}  // namespace calibrd
