// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/feed/state_feed.hpp"

#include <boost/json/object.hpp>
#include <cmath>

#include "api/json/calibration_result_json.hpp"
#include "api/json/json_text.hpp"
#include "api/routes/names.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr double kProgressSteps = 100;  // of an event each

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

json::object sensor_json(const SensorReport& sensor) {
  return {{"sensor", sensor.id},
          {"health", sensor.health},
          {"reason", text_or_null(sensor.reason)},
          {"notice", text_or_null(sensor.notice)}};
}

json::object pose_json(const PoseReport& pose) {
  return {{"sensor", pose.sensor_id},
          {"state", name_of(pose.state)},
          {"valid", pose.valid},
          {"reason", text_or_null(pose.reason)},
          {"calibration", pose.known ? json::value(pose.known->calibration_id) : json::value(nullptr)},
          {"candidate", text_or_null(pose.candidate)},
          {"job", text_or_null(pose.job)}};
}

json::object drift_json(const DriftReport& drift) {
  return {{"sensor", drift.sensor_id},
          {"watched", drift.watched},
          {"verdict", calibrd::name_of(drift.now.verdict)},
          {"meaning", calibrd::text_of(drift.now.verdict)}};
}

json::object robot_json(const RobotReport& robot) {
  return {{"link", robot.link_state},
          {"reason", text_or_null(robot.link_reason)},
          {"joints_stale", robot.joints_stale},
          {"joints_frozen", robot.joints_frozen},
          {"still", robot.still}};
}

json::object calibration_json(const CalibrationReport& calibration) {
  const auto& result = calibration.result;
  return {{"calibration", calibration.id},
          {"sensor", calibration.sensor_id},
          {"status", name_of(calibration.status)},
          {"progress", std::floor(kProgressSteps * calibration.progress) / kProgressSteps},
          {"message", text_or_null(calibration.message)},
          {"verdict", result ? json::value(name_of(result->verdict)) : json::value(nullptr)},
          {"current", calibration.current}};
}

}  // namespace

void StateFeed::look() {
  hub_.publish("robot", "robot", json_line(robot_json(service_.robot())));
  for (const SensorReport& sensor : service_.sensors()) {
    hub_.publish("sensor/" + sensor.id, "sensor", json_line(sensor_json(sensor)));
    if (const auto pose = service_.pose(sensor.id))
      hub_.publish("pose/" + sensor.id, "pose", json_line(pose_json(*pose)));
    if (const auto drift = service_.drift(sensor.id))
      hub_.publish("drift/" + sensor.id, "drift", json_line(drift_json(*drift)));
    look_at_calibrations(sensor);
  }
}

/// An end is told also of one that came and went since the last look.
void StateFeed::look_at_calibrations(const SensorReport& sensor) {
  std::string& told = ended_[sensor.id];
  if (told != sensor.ended_job) tell(sensor.id, told = sensor.ended_job);
  if (!sensor.job.empty()) tell(sensor.id, sensor.job);
}

void StateFeed::tell(const std::string& sensor_id, const std::string& calibration_id) {
  if (const auto calibration = service_.calibration(calibration_id))
    hub_.publish("calibration/" + sensor_id, "calibration", json_line(calibration_json(*calibration)));
}

}  // namespace calibrd::api
