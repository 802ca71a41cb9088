// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of LiveCell that looks at several sensors at once.
#include <cmath>

#include "api/problem/api_error.hpp"
#include "core/calibration/verdict.hpp"
#include "core/drift/moved_meanwhile.hpp"
#include "server/live_cell/live_cell.hpp"

namespace calibrd {
namespace {

constexpr double kStands_m = 0.005, kStands_rad = 0.005, kSigmas = 5;

/// Whether a frame shows the background where a pose puts it: until a pose is served nobody watches it.
bool shows(const View& frame, const BackgroundMap& background, const Pose& T_base_sensor, RobotMask& robot) {
  if (background.is_empty()) return true;
  std::span<const std::uint8_t> mask;
  if (!frame.joint_positions_rad.empty()) mask = robot.at(frame.joint_positions_rad, T_base_sensor);
  const auto seen = BackgroundMatcher(background).match(frame.depth, mask, T_base_sensor.linear());
  if (!seen.has_evidence) return false;
  const Vector6d sigma = seen.covariance.diagonal().cwiseSqrt();
  Vector6d allowed;
  allowed << Eigen::Vector3d::Constant(kStands_rad), Eigen::Vector3d::Constant(kStands_m);
  return (seen.shift.cwiseAbs() - kSigmas * sigma - allowed).maxCoeff() < 0;
}

}  // namespace

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

/// A sensor that was knocked between two views has no one pose that they show.
void LiveCell::reject_if_moved(const CameraModel& camera, std::span<const View> views,
                               CalibrationResult& result) const {
  const auto move =
      ViewsInOrder(virtual_cell_, camera).find_move(views, *result.T_base_sensor, result.depth_correction);
  if (!move) return;
  const std::string witness =
      move->witness == MovedMeanwhile::Witness::robot ? "the robot" : "what stands around the robot";
  result.verdict = Verdict::rejected;
  withhold_pose(result);
  result.reasons.push_back(
      {"sensor_moved_meanwhile",
       "the sensor seems to have moved while its postures were collected: between posture " +
           std::to_string(move->before + 1) + " and the next " + witness + " shifts by " +
           std::to_string(std::lround(1e3 * move->shift_m)) + " mm and " +
           std::to_string(std::lround(1e3 * move->turn_rad)) + " mrad; see that it is fixed, start again"});
}

Surroundings LiveCell::review(LiveSensor& sensor, std::span<const View> views, CalibrationResult& result) {
  reject_if_moved(sensor.camera(), views, result);
  if (!estimator_.make_watch || result.verdict != Verdict::accepted) return {};
  RobotMask robot(virtual_cell_, sensor.camera());
  auto background = std::make_shared<const BackgroundMap>(
      learn_background(robot, sensor.camera(), views, *result.T_base_sensor));
  std::vector<LiveSensor*> others;
  for (const auto& [id, entry] : entries_)
    if (entry->sensor.get() != &sensor) others.push_back(entry->sensor.get());
  auto objections = review_against(others, sensor, *background, result);
  const auto newest = sensor.newest();
  const bool is_there = !newest || shows(newest->view, *background, *result.T_base_sensor, robot);
  return {std::move(background), std::move(objections), !is_there};
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
