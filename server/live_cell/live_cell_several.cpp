// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of LiveCell that looks at several sensors at once.
#include "api/problem/api_error.hpp"
#include "server/live_cell/live_cell.hpp"

namespace calibrd {

Result<api::ObstaclesReport> LiveCell::obstacles(const std::string& sensor_id) const {
  if (!sensor_id.empty())
    if (const auto entry = find(sensor_id); !entry) return entry.error();
  api::ObstaclesReport report;
  report.base_frame = robot_.model().base_link();
  for (const Link& link : robot_.model().links()) report.links.push_back(link.name);
  for (const auto& [id, entry] : entries_)
    if (sensor_id.empty() || sensor_id == id) report.sensors.push_back(obstacle_watch_.look(*entry->sensor));
  return report;
}

Result<api::MergedCloud> LiveCell::merged_cloud(const api::MergedCloudRequest& request) const {
  std::vector<const LiveSensor*> sensors;
  for (const auto& [id, entry] : entries_) sensors.push_back(entry->sensor.get());
  return cloud_merger_.merge(sensors, request);
}

std::vector<api::SensorPair> LiveCell::cross_checks() const {
  std::vector<const LiveSensor*> sensors;
  for (const auto& [id, entry] : entries_) sensors.push_back(entry->sensor.get());
  return compare_pairs(sensors);
}

Surroundings LiveCell::review(LiveSensor& sensor, std::span<const View> views, CalibrationResult& result) {
  if (!estimator_.make_watch) return {};
  RobotMask robot(virtual_cell_, sensor.camera());
  auto background = std::make_shared<const BackgroundMap>(
      learn_background(robot, sensor.camera(), views, *result.T_base_sensor));
  std::vector<LiveSensor*> others;
  for (const auto& [id, entry] : entries_)
    if (entry->sensor.get() != &sensor) others.push_back(entry->sensor.get());
  auto objections = review_against(others, sensor, *background, result);
  return {std::move(background), std::move(objections)};
}

/// A pose that a better one contradicts is served no longer, and does not come back with a restart.
void LiveCell::withhold(const Objection& objection) {
  if (objection.sensor->withhold(objection.calibration_id, objection.reason))
    store_drift(objection.sensor->id(), objection.calibration_id);
}

Result<api::CellCalibrations> LiveCell::start_calibrations(const api::CellCalibrationRequest& request) {
  auto ids = request.sensor_ids;
  for (const auto& id : ids)
    if (const auto entry = find(id); !entry) return entry.error();
  if (ids.empty())
    for (const auto& [id, entry] : entries_) ids.push_back(id);
  api::CellCalibrations calibrations;
  for (const auto& id : ids) {
    auto each = request.each;
    each.sensor_id = id;
    if (auto started = start_calibration(each))
      calibrations.started.push_back(*std::move(started));
    else
      calibrations.refused.push_back({id, started.error()});
  }
  if (calibrations.started.empty() && !calibrations.refused.empty())
    return calibrations.refused.front().error;
  return calibrations;
}

}  // namespace calibrd
