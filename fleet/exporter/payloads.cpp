// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/payloads.hpp"

#include <algorithm>
#include <boost/json/object.hpp>
#include <cstdio>

#include "api/json/calibration_result_json.hpp"
#include "api/json/calibration_result_object.hpp"
#include "api/json/json_text.hpp"
#include "api/json/pose_json.hpp"
#include "api/routes/cell_json.hpp"
#include "api/routes/names.hpp"
#include "core/base/utc_text.hpp"

namespace calibrd::fleet {
namespace {

namespace json = boost::json;

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

std::string rfc3339(api::SystemTime time) {
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count() % 1000;
  char fraction[8];
  std::snprintf(fraction, sizeof fraction, ".%03dZ", static_cast<int>(ms));
  return utc_text(time, kUtcSeconds) + fraction;
}

}  // namespace

api::Seconds rest_of_validity(const api::PoseReport& pose) {
  if (!pose.valid || !pose.passed_check_age) return api::Seconds(0);
  return std::clamp(api::Seconds(pose.max_unverified - *pose.passed_check_age), api::Seconds(0),
                    api::Seconds(kKept));
}

std::string status_payload(const Teller& teller, bool online, std::optional<api::SystemTime> since) {
  json::object body{{"format", "status/1"},
                    {"cell", teller.cell},
                    {"online", online},
                    {"version", teller.version},
                    {"instance", teller.instance}};
  if (since) body["since"] = rfc3339(*since);
  return api::json_line(body);
}

std::string pose_payload(const std::string& cell, const api::PoseReport& pose, api::SystemTime now,
                         bool with_end) {
  json::object body{
      {"format", "pose/1"},
      {"cell", cell},
      {"sensor", pose.sensor_id},
      {"state", api::name_of(pose.state)},
      {"valid", pose.valid},
      {"reason", text_or_null(pose.reason)},
      {"base_frame", pose.base_frame},
      {"sensor_frame", pose.sensor_frame},
      {"calibration", pose.known ? json::value(pose.known->calibration_id) : json::value(nullptr)}};
  if (pose.valid && pose.known && pose.known->result.T_base_sensor) {
    const auto& known = *pose.known;
    body["calibrated_at"] = rfc3339(known.calibrated_at);
    body["T_base_sensor"] = api::matrix_json(*known.result.T_base_sensor);
    body["sigma_position_m"] = known.result.sigma_position_m;
    body["sigma_rotation_rad"] = known.result.sigma_rotation_rad;
    if (with_end)
      body["valid_until"] =
          rfc3339(now + std::chrono::duration_cast<api::SystemTime::duration>(rest_of_validity(pose)));
  }
  return api::json_line(body);
}

std::string state_payload(const std::string& cell, const api::SensorReport& sensor,
                          const api::PoseReport& pose, const api::DriftReport& drift) {
  return api::json_line(json::object{{"format", "state/1"},
                                     {"cell", cell},
                                     {"sensor", sensor.id},
                                     {"health", sensor.health},
                                     {"health_reason", text_or_null(sensor.reason)},
                                     {"pose_state", api::name_of(pose.state)},
                                     {"pose_valid", pose.valid},
                                     {"candidate", text_or_null(pose.candidate)},
                                     {"job", text_or_null(pose.job)},
                                     {"watched", drift.watched},
                                     {"drift", calibrd::name_of(drift.now.verdict)}});
}

std::string calibration_payload(const std::string& cell, const api::CalibrationReport& calibration) {
  auto body = api::calibration_json(calibration, false);
  // Of the moment, and not of the calibration.
  for (const char* key : {"current", "progress"}) body.erase(key);
  body["format"] = "calibration/1";
  body["cell"] = cell;
  body["software_version"] =
      calibration.evidence ? text_or_null(calibration.evidence->software_version) : json::value(nullptr);
  body["result"] = calibration.result ? json::value(api::calibration_result_object(*calibration.result))
                                      : json::value(nullptr);
  return api::json_line(body);
}

}  // namespace calibrd::fleet
