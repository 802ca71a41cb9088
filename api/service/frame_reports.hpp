// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/obstacles/pixel_classes.hpp"
#include "core/sensing/images.hpp"

namespace calibrd::api {

struct SensorFrameRequest {
  std::string sensor_id;
  int step = 1;                                      ///< every step-th pixel in both directions
  std::optional<Clock::time_point> newer_than = {};  ///< SensorFrame::stamp of one that is there already
};

/// The newest frame of a sensor beside what it should show, pixel by pixel; row-major, of `camera`'s grid.
/// Depths along the optical axis, in units of depth_scale_m; 0: none.
struct SensorFrame {
  CameraModel camera;  ///< subsampled
  double depth_scale_m = 0.001;
  std::vector<std::uint16_t> depth;
  std::vector<std::uint16_t>
      predicted;                   ///< what the robot would be measured at, known bias of the sensor included
  std::vector<std::uint8_t> link;  ///< index into `links`; kNoLink: no robot is predicted
  std::vector<PixelClass> pixel_class;
  std::vector<std::string> links;
  Clock::time_point stamp;                  ///< of the frame's arrival
  Clock::time_point exposed;                ///< as far as latency and time offset are known
  std::vector<double> joint_positions_rad;  ///< of that moment; empty: not known, nothing is predicted
  std::optional<Pose> T_base_sensor;        ///< what the prediction was made with: last known, or the guess
  bool pose_valid = false;                  ///< T_base_sensor is a valid pose
  static constexpr std::uint8_t kNoLink = 255;
};

}  // namespace calibrd::api
