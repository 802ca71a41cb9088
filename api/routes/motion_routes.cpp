// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/value_from.hpp>

#include "api/json/strict_object.hpp"
#include "api/routes/names.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr std::size_t kMaxName = 64;

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

json::object motion_json(const MotionReport& motion) {
  return {{"id", motion.id},
          {"status", name_of(motion.status)},
          {"route", text_or_null(motion.route)},
          {"next_posture_of", text_or_null(motion.next_posture_of)},
          {"postures", motion.postures},
          {"reached", motion.reached},
          {"commands", motion.commands},
          {"message", text_or_null(motion.message)},
          {"created_at", rfc3339(motion.created)},
          {"finished_at", motion.finished ? json::value(rfc3339(*motion.finished)) : nullptr}};
}

json::object motions_json(const MotionsReport& motions) {
  json::array list;
  for (const auto& motion : motions.motions) list.push_back(motion_json(motion));
  return {{"enabled", motions.enabled},
          {"hindrance", text_or_null(motions.hindrance)},
          {"routes", json::value_from(motions.routes)},
          {"motions", std::move(list)}};
}

/// The positions alone, or the object that next-posture gave, which holds them.
Result<std::vector<double>> read_approved(const json::object& body) {
  const auto* value = body.if_contains("approve");
  if (value && value->is_object()) value = value->get_object().if_contains("positions_rad");
  const auto numbers = value ? flat_numbers(*value) : std::nullopt;
  if (numbers && !numbers->empty()) return *numbers;
  return fail(ApiError::bad_value, "approve: positions_rad of GET …/next-posture are wanted");
}

Result<MotionRequest> read_motion_request(const Request& request) {
  const auto body =
      read_body(request.body, request.header("content-type"), {"route", "next_posture_of", "approve"});
  if (!body) return body.error();
  const auto route = read_text(*body, "route", kMaxName);
  if (!route) return route.error();
  const auto sensor = read_text(*body, "next_posture_of", kMaxName);
  if (!sensor) return sensor.error();
  if (route->has_value() == sensor->has_value())
    return fail(ApiError::bad_value, "either route or next_posture_of is wanted");
  if (*route && body->contains("approve"))
    return fail(ApiError::bad_value, "approve belongs to next_posture_of");
  if (*route) return MotionRequest{**route, {}, {}};
  const auto approved = read_approved(*body);
  if (!approved) return approved.error();
  return MotionRequest{{}, **sensor, *approved};
}

Response answer_start(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto wanted = read_motion_request(request);
  if (!wanted) return problem(wanted.error());
  const auto started = service.start_motion(*wanted);
  if (!started) return problem(started.error());
  auto response = json_response(202, motion_json(*started));
  response.headers.emplace_back("Location", "/api/v1/robot/motions/" + started->id);
  return response;
}

Response answer_one(const Request& request, const Result<MotionReport>& motion) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  return motion ? json_response(200, motion_json(*motion)) : problem(motion.error());
}

}  // namespace

/// Stopping must never wait behind anything slow: it is made on the network thread.
void add_motion_routes(Router& router, CellService& service) {
  router.add(
      "POST", "/api/v1/robot/motions", Scope::admin, Cost::slow,
      [&service](const Request& request, const PathValues&) { return answer_start(request, service); });
  router.add("GET", "/api/v1/robot/motions", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues&) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return json_response(200, motions_json(service.motions()));
             });
  router.add("GET", "/api/v1/robot/motions/{id}", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_one(request, service.motion(values[0]));
             });
  router.add("DELETE", "/api/v1/robot/motions/{id}", Scope::calibrate, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_one(request, service.stop_motion(values[0]));
             });
}

}  // namespace calibrd::api
