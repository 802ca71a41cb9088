// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/cell_json.hpp"

#include <boost/json/array.hpp>
#include <boost/json/value_from.hpp>

#include "api/json/calibration_result_json.hpp"
#include "api/json/calibration_result_object.hpp"
#include "api/json/camera_json.hpp"
#include "api/json/pose_json.hpp"
#include "api/routes/names.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

json::value or_null(const std::optional<bool>& value) {
  return value ? json::value(*value) : json::value(nullptr);
}

json::array numbers(const std::vector<double>& values) {
  json::array list;
  for (const double value : values) list.emplace_back(value);
  return list;
}

json::value or_null(const std::optional<Seconds>& value) {
  return value ? json::value(value->count()) : json::value(nullptr);
}

json::object time_offset_json(const TimeOffsetReport& offset) {
  return {{"source", offset.applied ? "estimated" : "configured"},
          {"estimating", offset.is_estimated},
          {"applied", offset.applied},
          {"value_s", or_null(offset.value)},
          {"sigma_s", or_null(offset.sigma)},
          {"jitter_s", or_null(offset.jitter)},
          {"age_s", or_null(offset.age)},
          {"reason", text_or_null(offset.reason)}};
}

json::object views_json(const ViewReport& views) {
  json::object refused;
  for (const auto& [code, count] : views.refused) refused[code] = count;
  return {
      {"usable", views.usable},
      {"code", views.code},
      {"reason", text_or_null(views.reason)},
      {"views", views.views},
      {"moving_views", views.moving_views},
      {"timing_error_m", views.timing_error_m ? json::value(*views.timing_error_m) : json::value(nullptr)},
      {"frames_refused", std::move(refused)}};
}

json::value joints_json(const RobotReport& robot) {
  if (!robot.joints) return nullptr;
  json::array joints;
  for (std::size_t i = 0; i < robot.joint_names.size() && i < robot.joints->positions_rad.size(); ++i)
    joints.push_back({{"name", robot.joint_names[i]}, {"position_rad", robot.joints->positions_rad[i]}});
  return json::object{{"positions_rad", numbers(robot.joints->positions_rad)},
                      {"velocities_rad_s", numbers(robot.joints->velocities_rad)},
                      {"sequence", robot.joints->sequence},
                      {"stamp_ns", robot.joints->stamp.time_since_epoch() / std::chrono::nanoseconds(1)},
                      {"age_s", robot.joints_age.count()},
                      {"stale", robot.joints_stale},
                      {"frozen", robot.joints_frozen},
                      {"still", robot.still},
                      {"by_name", std::move(joints)}};
}

json::value controller_json(const std::optional<ControllerReport>& controller) {
  if (!controller) return nullptr;
  return json::object{{"drives_powered", or_null(controller->drives_powered)},
                      {"e_stopped", or_null(controller->e_stopped)},
                      {"in_error", or_null(controller->in_error)},
                      {"in_motion", or_null(controller->in_motion)},
                      {"motion_possible", or_null(controller->motion_possible)},
                      {"mode", controller->mode},
                      {"error_code", controller->error_code},
                      {"fresh", controller->fresh},
                      {"age_s", controller->age.count()}};
}

json::array links_json(const RobotReport& robot) {
  json::array links;
  for (const auto& link : robot.links)
    links.push_back({{"name", link.name}, {"T_base_link", matrix_json(link.T_base_link)}});
  return links;
}

json::value evidence_json(const CalibrationReport& calibration) {
  const auto& evidence = calibration.evidence;
  if (!evidence) return nullptr;
  json::array views;
  for (const auto& view : evidence->views)
    views.push_back(
        {{"stamp_s", view.stamp_s}, {"joint_positions_rad", json::value_from(view.joint_positions_rad)}});
  json::value capture = nullptr;
  if (const auto bytes = calibration.capture_bytes)
    capture = {{"path", "/api/v1/calibrations/" + calibration.id + "/capture"}, {"bytes", *bytes}};
  return {{"software_version", evidence->software_version},
          {"configuration", evidence->configuration},
          {"joint_names", json::value_from(evidence->joint_names)},
          {"views", std::move(views)},
          {"capture", std::move(capture)}};
}

}  // namespace

json::object sensor_json(const SensorReport& sensor) {
  return {{"id", sensor.id},
          {"health", sensor.health},
          {"reason", text_or_null(sensor.reason)},
          {"device", text_or_null(sensor.device)},
          {"notice", text_or_null(sensor.notice)},
          {"frames", sensor.frames},
          {"frames_lost", sensor.frames_lost},
          {"restarts", sensor.restarts},
          {"frame_rate_hz", sensor.frame_rate_hz},
          {"frame_age_s", sensor.frame_age ? json::value(sensor.frame_age->count()) : json::value(nullptr)},
          {"has_image", sensor.has_image},
          {"camera", camera_json(sensor.camera)},
          {"views", views_json(sensor.views)},
          {"time_offset", time_offset_json(sensor.time_offset)},
          {"pose", {{"state", name_of(sensor.pose_state)}, {"valid", sensor.pose_valid}}},
          {"job", text_or_null(sensor.job)}};
}

json::object robot_json(const RobotReport& robot) {
  return {{"model", robot.model},
          {"base_frame", robot.base_frame},
          {"controller_frame", text_or_null(robot.controller_frame)},
          {"link",
           {{"state", robot.link_state},
            {"reason", text_or_null(robot.link_reason)},
            {"connects", robot.connects},
            {"framing_errors", robot.framing_errors},
            {"rejected_values", robot.rejected_values}}},
          {"joint_names", json::value_from(robot.joint_names)},
          {"joints", joints_json(robot)},
          {"controller", controller_json(robot.controller)},
          {"links", links_json(robot)}};
}

json::object live_joints_json(const RobotReport& robot) {
  if (!robot.joints)
    return {{"positions_rad", nullptr}, {"stamp_ns", nullptr}, {"age_s", nullptr}, {"stale", true},
            {"frozen", false},          {"still", false}};
  return {{"positions_rad", numbers(robot.joints->positions_rad)},
          {"stamp_ns", robot.joints->stamp.time_since_epoch() / std::chrono::nanoseconds(1)},
          {"age_s", robot.joints_age.count()},
          {"stale", robot.joints_stale},
          {"frozen", robot.joints_frozen},
          {"still", robot.still}};
}

json::object calibration_json(const CalibrationReport& calibration, bool with_result) {
  const auto& result = calibration.result;
  json::object body{
      {"id", calibration.id},
      {"sensor", calibration.sensor_id},
      {"status", name_of(calibration.status)},
      {"verdict", result ? json::value(name_of(result->verdict)) : json::value(nullptr)},
      {"current", calibration.current},
      {"progress", calibration.progress},
      {"message", text_or_null(calibration.message)},
      {"created_at", rfc3339(calibration.created)},
      {"finished_at", calibration.finished ? json::value(rfc3339(*calibration.finished)) : nullptr},
      {"method", name_of(calibration.method)},
      {"postures", calibration.postures_wanted},
      {"postures_seen", calibration.postures_seen},
      {"activate", calibration.activate}};
  if (!with_result) return body;
  body["result"] = result ? json::value(calibration_result_object(*result)) : json::value(nullptr);
  body["evidence"] = evidence_json(calibration);
  return body;
}

}  // namespace calibrd::api
