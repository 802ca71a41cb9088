// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/meshes/binary_stl.hpp"
#include "api/routes/cell_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/robot_joints_stream.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

Response answer_robot(const Request& request, const CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  return json_response(200, robot_json(service.robot()));
}

/// The model does not change while the daemon runs; the next run may have another.
Response model_file(const char* content_type, std::string bytes) {
  return {200, {{"Content-Type", content_type}, {"Cache-Control", "no-cache"}}, std::move(bytes)};
}

Response answer_urdf(const Request& request, const CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  return model_file("application/xml", service.robot_urdf());
}

Response answer_mesh(const Request& request, const PathValues& values, const CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto surface = service.link_surface(values[0]);
  return surface ? model_file("model/stl", binary_stl(*surface)) : problem(surface.error());
}

Response answer_joints(const Request& request, const CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  Response response{200, {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-store"}}, {}};
  response.stream = std::make_shared<RobotJointsStream>(service);
  return response;
}

}  // namespace

void add_robot_routes(Router& router, CellService& service) {
  router.add(
      "GET", "/api/v1/robot", Scope::read, Cost::quick,
      [&service](const Request& request, const PathValues&) { return answer_robot(request, service); });
  router.add(
      "GET", "/api/v1/robot/joints", Scope::read, Cost::quick,
      [&service](const Request& request, const PathValues&) { return answer_joints(request, service); });
  router.add("GET", "/api/v1/robot/urdf", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues&) { return answer_urdf(request, service); });
  router.add("GET", "/api/v1/robot/links/{link}/mesh", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_mesh(request, values, service);
             });
}

}  // namespace calibrd::api
