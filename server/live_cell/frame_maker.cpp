// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/frame_maker.hpp"

#include <algorithm>
#include <cmath>

#include "api/problem/api_error.hpp"
#include "server/live_cell/sound_sighting.hpp"

namespace calibrd {
namespace {

using api::SensorFrame;

std::uint16_t raw_depth(double depth_m, double scale_m) {
  return static_cast<std::uint16_t>(std::clamp(std::lround(depth_m / scale_m), 0L, 65535L));
}

std::vector<std::uint16_t> sparse_depth(const DepthImage& depth, int step, const CameraModel& grid) {
  std::vector<std::uint16_t> sparse;
  sparse.reserve(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) sparse.push_back(depth.raw[depth.index(x * step, y * step)]);
  return sparse;
}

}  // namespace

Result<std::optional<SensorFrame>> FrameMaker::make(const api::SensorFrameRequest& request,
                                                    const LiveSensor& sensor,
                                                    const std::optional<Pose>& guess) {
  const auto sighting = fresh_sighting(sensor);
  if (!sighting) return fail(api::ApiError::no_frame, sensor.id() + ": " + sensor.hindrance());
  if (request.newer_than && sighting->stamp <= *request.newer_than) return std::optional<SensorFrame>();
  const View& view = sighting->view;
  const auto background = sensor.background();
  const auto pose = pose_to_use(sensor, guess);
  SensorFrame frame;
  frame.camera = sensor.camera().subsampled(request.step);
  frame.depth_scale_m = view.depth.scale_m;
  frame.depth = sparse_depth(view.depth, request.step, frame.camera);
  frame.stamp = sighting->stamp;
  frame.exposed = sighting->exposed;
  frame.joint_positions_rad = view.joint_positions_rad;
  frame.pose_valid = pose && pose->valid;
  const std::lock_guard lock(mutex_);
  for (const auto& link : cell_.robot().links()) frame.links.push_back(link.name);
  if (pose) frame.T_base_sensor = pose->T_base_sensor;
  robot_ = {};
  frame.predicted.assign(frame.depth.size(), 0);
  frame.link.assign(frame.depth.size(), SensorFrame::kNoLink);
  if (pose && !view.joint_positions_rad.empty()) predict(*pose, frame);
  frame.pixel_class =
      classify_pixels({view.depth, request.step, *cell_.pixel_rays(frame.camera), robot_, background.get()});
  return std::optional(std::move(frame));
}

/// In what the sensor would measure, so that the difference shows the pose and not the sensor's known bias.
void FrameMaker::predict(const UsedPose& pose, SensorFrame& frame) {
  cell_.set_joints(frame.joint_positions_rad);
  cell_.measure(frame.camera, pose.T_base_sensor, robot_);
  for (std::size_t pixel = 0; pixel < frame.depth.size(); ++pixel) {
    if (robot_.link[pixel] < 0) continue;
    const double measured_m = pose.correction.measured(static_cast<double>(robot_.depth_m[pixel]));
    robot_.depth_m[pixel] = static_cast<float>(measured_m);
    frame.predicted[pixel] = raw_depth(measured_m, frame.depth_scale_m);
    frame.link[pixel] =
        static_cast<std::uint8_t>(std::min<int>(robot_.link[pixel], SensorFrame::kNoLink - 1));
  }
}

}  // namespace calibrd
