// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/json/object.hpp>
#include <charconv>
#include <sstream>

#include "api/json/pose_json.hpp"
#include "api/routes/names.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr double kLongestWait_ms = 60'000;

using FormatWriter = void (*)(json::object&, const Pose&);

struct Format {
  const char* name;
  FormatWriter write;
};

void write_matrix(json::object& body, const Pose& T_base_sensor) {
  body["unit"] = "m";
  body["layout"] = "4x4, row-major";
  body["T_base_sensor"] = matrix_json(T_base_sensor);
}

void write_quaternion(json::object& body, const Pose& T_base_sensor) {
  body["unit"] = "m";
  body["layout"] = "quaternion x y z w";
  body["translation_m"] = translation_json(T_base_sensor);
  body["rotation_xyzw"] = rotation_xyzw_json(T_base_sensor);
}

constexpr std::array kFormats{Format{"matrix", write_matrix}, Format{"quaternion", write_quaternion}};

const Format* find_format(const std::string& name) {
  for (const auto& format : kFormats)
    if (name == format.name) return &format;
  return nullptr;
}

std::string format_names() {
  std::string names;
  for (const auto& format : kFormats) names += std::string(names.empty() ? "" : ", ") + format.name;
  return names;
}

std::string seconds_text(Seconds age) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(3);
  text << age.count();
  return text.str();
}

/// Equal while a client would do the same with the pose; ages are headers for that reason.
std::string etag(const PoseReport& pose) {
  return "W/\"" + (pose.known ? pose.known->calibration_id : std::string("none")) + "." +
         name_of(pose.state) + (pose.valid ? ".valid\"" : ".invalid\"");
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

Response format_response(const PoseReport& pose, const Format& format) {
  if (!pose.valid || !pose.known)
    return problem(ApiError::pose_not_valid,
                   "state is " + std::string(name_of(pose.state)) + ": " + pose.reason);
  auto body = heading_json(pose);
  body["calibration"] = pose.known->calibration_id;
  body["format"] = format.name;
  format.write(body, *pose.known->result.T_base_sensor);
  return json_response(200, body);
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

Response respond(const Request& request, const PoseReport& pose, const Format* format,
                 std::chrono::milliseconds wait) {
  auto response = format ? format_response(pose, *format) : json_response(200, full_body(pose));
  const auto tag = etag(pose);
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
  const auto* format = asked == request.query.end() ? nullptr : find_format(asked->second);
  if (asked != request.query.end() && !format)
    return problem(ApiError::unknown_format, asked->second + " is not one of " + format_names());
  const auto wait = read_wait(request);
  if (!wait) return problem(wait.error());
  const auto pose = service.pose(values[0]);
  return pose ? respond(request, *pose, format, *wait) : problem(pose.error());
}

}  // namespace

void add_pose_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/sensors/{id}/pose", Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_pose(request, values, service);
             });
}

}  // namespace calibrd::api
