// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <mutex>
#include <string>

#include "api/service/cell_reports.hpp"
#include "core/obstacles/find_obstacles.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// Looks for obstacles in the newest frame of a sensor. Nothing is computed until it is asked. Safe to call
/// from any thread; one look at a time.
class ObstacleWatch {
 public:
  explicit ObstacleWatch(const VirtualCell& cell) : cell_(cell) {}

  api::SensorObstacles look(const LiveSensor& sensor);

 private:
  ObstacleFinder& finder(const LiveSensor& sensor);

  std::mutex mutex_;  // guards what follows
  VirtualCell cell_;
  std::map<std::string, ObstacleFinder> finders_;  // by sensor
};

}  // namespace calibrd
