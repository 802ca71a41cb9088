// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

#include "api/json/json_text.hpp"
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
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), age.count(), std::chars_format::fixed, 3).ptr;
  return {text.begin(), end};
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
  if (pose.known) response.headers.emplace_back("Calibrd-Calibrated-Age-S", seconds_text(pose.age));
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

/// The body of each sensor's pose as it was written last: a pose that is polled changes a few times a minute,
/// but for its ages, and those are no part of it. Safe to call from any thread.
class PoseBodies {
 public:
  std::string text(const PoseReport& pose) {
    const std::lock_guard lock(mutex_);
    auto& last = last_[pose.sensor_id];
    if (!last || !tell_the_same(last->pose, pose)) last = Written{pose, json_text(full_body(pose))};
    return last->text;
  }

 private:
  struct Written {
    PoseReport pose;
    std::string text;
  };
  static auto told(const PoseReport& pose) {
    return std::tie(pose.valid, pose.state, pose.reason, pose.candidate, pose.job, pose.base_frame,
                    pose.sensor_frame, pose.max_unverified);
  }
  static auto told(const CheckReport& check) {
    return std::tie(check.agrees, check.agreement, check.median_residual_m);
  }
  static bool tell_the_same(const PoseReport& a, const PoseReport& b) {
    if (told(a) != told(b) || a.known.has_value() != b.known.has_value()) return false;
    if (a.last_check.has_value() != b.last_check.has_value()) return false;
    if (a.last_check && told(*a.last_check) != told(*b.last_check)) return false;
    return !a.known || tell_the_same(*a.known, *b.known);
  }
  static bool tell_the_same(const PoseReport::Known& a, const PoseReport::Known& b) {
    return a.calibration_id == b.calibration_id && a.calibrated_at == b.calibrated_at &&
           a.result.T_base_sensor->matrix() == b.result.T_base_sensor->matrix() &&
           a.result.sigma_position_m == b.result.sigma_position_m &&
           a.result.sigma_rotation_rad == b.result.sigma_rotation_rad;
  }

  std::mutex mutex_;
  std::map<std::string, std::optional<Written>> last_;
};

/// Error: no_controller_frame.
Result<Response> first_response(const PoseReport& pose, const PoseFormat* format, PoseBodies& bodies) {
  if (!format) return json_response(200, bodies.text(pose));
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
                 std::chrono::milliseconds wait, PoseBodies& bodies) {
  auto first = first_response(pose, format, bodies);
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

Response answer_pose(const Request& request, const PathValues& values, CellService& service,
                     PoseBodies& bodies) {
  if (auto unknown = unknown_query(request, {"format", "wait"})) return problem(*unknown);
  const auto asked = request.query.find("format");
  const auto* format = asked == request.query.end() ? nullptr : find_pose_format(asked->second);
  if (asked != request.query.end() && !format)
    return problem(ApiError::unknown_format, asked->second + " is not one of " + pose_format_names());
  const auto wait = read_wait(request);
  if (!wait) return problem(wait.error());
  const auto pose = service.pose(values[0]);
  return pose ? respond(request, *pose, format, *wait, bodies) : problem(pose.error());
}

}  // namespace

void add_pose_routes(Router& router, CellService& service) {
  router.add(
      "GET", "/api/v1/sensors/{id}/pose", Scope::read, Cost::quick,
      [&service, bodies = std::make_shared<PoseBodies>()](const Request& request, const PathValues& values) {
        return answer_pose(request, values, service, *bodies);
      });
}

}  // namespace calibrd::api
