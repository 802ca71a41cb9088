// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mutex>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "server/live_cell/live_robot.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// Makes point clouds of what a sensor measures, of what it should measure, and of the difference. Nothing is
/// computed until one is asked for. Safe to call from any thread; one cloud at a time. Errors: api::ApiError.
class CloudMaker {
 public:
  CloudMaker(VirtualCell cell, const LiveRobot& robot) : cell_(std::move(cell)), robot_(robot) {}

  /// `guess`: the pose that is used while the sensor has none.
  Result<api::Cloud> make(const api::CloudRequest& request, const LiveSensor& sensor,
                          const std::optional<Pose>& guess);

 private:
  Result<api::Cloud> measured(const LiveSensor& sensor) const;
  Result<api::Cloud> virtual_cloud(const LiveSensor& sensor, const Pose& T_base_sensor);
  Result<api::Cloud> residual(const LiveSensor& sensor, const Pose& T_base_sensor,
                              const DepthCorrection& correction);
  void measure(const CameraModel& camera, const std::vector<double>& positions, const Pose& T_base_sensor);

  std::mutex mutex_;  // guards cell_ and measurement_
  VirtualCell cell_;
  VirtualMeasurement measurement_;
  const LiveRobot& robot_;
};

}  // namespace calibrd
