// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mutex>

#include "api/service/frame_reports.hpp"
#include "core/base/result.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "server/live_cell/live_sensor.hpp"
#include "server/live_cell/used_pose.hpp"

namespace calibrd {

/// Puts what a sensor measures beside what it should measure, for people to look at. Nothing is computed
/// until it is asked. Safe to call from any thread; one frame at a time. Errors: api::ApiError.
class FrameMaker {
 public:
  explicit FrameMaker(const VirtualCell& cell) : cell_(cell) {}

  /// `guess`: the pose that is used while the sensor has none.
  /// Nothing: there is no newer frame than asked for.
  Result<std::optional<api::SensorFrame>> make(const api::SensorFrameRequest& request,
                                               const LiveSensor& sensor, const std::optional<Pose>& guess);

 private:
  void predict(const UsedPose& pose, api::SensorFrame& frame);

  std::mutex mutex_;  // guards what follows
  VirtualCell cell_;
  VirtualMeasurement robot_;
};

}  // namespace calibrd
