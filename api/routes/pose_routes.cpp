// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <functional>
#include <sstream>

#include "api/json/pose_json.hpp"
#include "api/pose_formats/pose_format.hpp"
#include "api/routes/names.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr double kLongestWait_ms = 60'000;

std::string seconds_text(Seconds age) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(3);
  text << age.count();
  return text.str();
}

/// After a restart the same calibration may be given in another controller frame.
std::string controller_mark(const ControllerFrame& frame) {
  const auto told = frame.link + json::serialize(matrix_json(frame.T_base_controller));
  return std::string(".").append(std::to_string(std::hash<std::string>{}(told)));
}

/// Equal while a client would do the same with the pose; ages are headers for that reason.
std::string etag(const PoseReport& pose, const PoseFormat* format) {
  const bool is_controllers = format && format->reference == Reference::controller && pose.controller_frame;
  return "W/\"" + (pose.known ? pose.known->calibration_id : std::string("none")) + "." +
         name_of(pose.state) + (pose.valid ? ".valid" : ".invalid") +
         (is_controllers ? controller_mark(*pose.controller_frame) : std::string()) + "\"";
}

bool etag_matches(const std::string& if_none_match, const std::string& tag) {
  if (if_none_match == "*") return true;
  const auto opaque = tag.substr(2);  // weak comparison: W/ aside
  return if_none_match.find(opaque) != std::string::npos;
}

void add_age_headers(Response& response, const PoseReport& pose) {
  if (pose.known) {
    const auto age = std::chrono::system_clock::now() - pose.known->calibrated_at;
    response.headers.emplace_back("Calibrd-Calibrated-Age-S", seconds_text(age));
  }
  if (pose.last_check)
    response.headers.emplace_back("Calibrd-Last-Check-Age-S", seconds_text(pose.last_check->age));
  if (pose.passed_check_age)
    response.headers.emplace_back("Calibrd-Passed-Check-Age-S", seconds_text(*pose.passed_check_age));
}

json::object known_json(const PoseReport::Known& known) {
  const auto& pose = *known.result.T_base_sensor;
  return {{"calibration", known.calibration_id},
          {"calibrated_at", rfc3339(known.calibrated_at)},
          {"unit", "m"},
          {"T_base_sensor", matrix_json(pose)},
          {"translation_m", translation_json(pose)},
          {"rotation_xyzw", rotation_xyzw_json(pose)},
          {"sigma_position_m", known.result.sigma_position_m},
          {"sigma_rotation_rad", known.result.sigma_rotation_rad}};
}

json::value check_json(const PoseReport& pose) {
  if (!pose.last_check) return nullptr;
  return json::object{{"agrees", pose.last_check->agrees},
                      {"agreement", pose.last_check->agreement},
                      {"median_residual_m", pose.last_check->median_residual_m}};
}

json::object heading_json(const PoseReport& pose) {
  return {{"sensor", pose.sensor_id},
          {"valid", pose.valid},
          {"state", name_of(pose.state)},
          {"base_frame", pose.base_frame},
          {"sensor_frame", pose.sensor_frame},
          {"meaning",
           "T_base_sensor maps points of the sensor frame (x right, y down, z forward) to the base frame"}};
}

json::object full_body(const PoseReport& pose) {
  auto body = heading_json(pose);
  if (!pose.valid) body["reason"] = pose.reason;
  body["candidate"] = pose.candidate.empty() ? json::value(nullptr) : json::value(pose.candidate);
  body["job"] = pose.job.empty() ? json::value(nullptr) : json::value(pose.job);
  body["max_unverified_s"] = pose.max_unverified.count();
  body["last_check"] = check_json(pose);
  if (pose.valid && pose.known)
    for (auto& member : known_json(*pose.known)) body[member.key()] = member.value();
  else
    body["last_known"] = pose.known ? json::value(known_json(*pose.known)) : json::value(nullptr);
  return body;
}

Response not_valid(const PoseReport& pose) {
  return problem(ApiError::pose_not_valid,
                 "state is " + std::string(name_of(pose.state)) + ": " + pose.reason);
}

json::object format_body(const PoseReport& pose, const PoseFormat& format, const FramedPose& given) {
  json::object body{{"sensor", pose.sensor_id},
                    {"valid", pose.valid},
                    {"state", name_of(pose.state)},
                    {"calibration", pose.known->calibration_id},
                    {"sigma_position_m", pose.known->result.sigma_position_m},
                    {"sigma_rotation_rad", pose.known->result.sigma_rotation_rad}};
  for (auto& member : pose_members(format, given)) body[member.key()] = std::move(member.value());
  return body;
}

/// Error: no_controller_frame.
Result<Response> first_response(const PoseReport& pose, const PoseFormat* format) {
  if (!format) return json_response(200, full_body(pose));
  if (!pose.valid || !pose.known) return not_valid(pose);
  const auto given = refer({*pose.known->result.T_base_sensor, pose.base_frame, pose.sensor_frame},
                           format->reference, pose.controller_frame);
  if (!given)
    return fail(ApiError::no_controller_frame,
                std::string(format->name) + " is given in the frame of the robot controller");
  return json_response(200, format_body(pose, *format, *given));
}

/// ?wait=30s or 500ms, at most a minute.
Result<std::chrono::milliseconds> read_wait(const Request& request) {
  const auto asked = request.query.find("wait");
  if (asked == request.query.end()) return std::chrono::milliseconds(0);
  const auto& text = asked->second;
  double count = 0;
  const auto [unit, failure] = std::from_chars(text.data(), text.data() + text.size(), count);
  const std::string_view rest(unit, static_cast<std::size_t>(text.data() + text.size() - unit));
  const double ms = rest == "s" ? count * 1000 : count;
  if (failure != std::errc() || (rest != "s" && rest != "ms") || !(ms >= 0 && ms <= kLongestWait_ms))
    return fail(ApiError::bad_query, "wait: \"" + text + "\" is not a time up to 60s, such as 30s or 500ms");
  return std::chrono::milliseconds(static_cast<int>(ms));
}

Response respond(const Request& request, const PoseReport& pose, const PoseFormat* format,
                 std::chrono::milliseconds wait) {
  auto first = first_response(pose, format);
  if (!first) return problem(first.error());  // however long one waits
  auto response = *std::move(first);
  const auto tag = etag(pose, format);
  const bool unchanged = etag_matches(request.header("if-none-match"), tag);
  if (response.status == 200 && unchanged) response = {304, {}, {}, {}};
  if (unchanged) response.worth_waiting = wait;
  response.headers.emplace_back("ETag", tag);
  add_age_headers(response, pose);
  return response;
}

Response answer_pose(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {"format", "wait"})) return problem(*unknown);
  const auto asked = request.query.find("format");
  const auto* format = asked == request.query.end() ? nullptr : find_pose_format(asked->second);
  if (asked != request.query.end() && !format)
    return problem(ApiError::unknown_format, asked->second + " is not one of " + pose_format_names());
  const auto wait = read_wait(request);
  if (!wait) return problem(wait.error());
  const auto pose = service.pose(values[0]);
  return pose ? respond(request, *pose, format, *wait) : problem(pose.error());
}

}  // namespace

void add_pose_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/sensors/{id}/pose", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_pose(request, values, service);
             });
}

}  // namespace calibrd::api
