// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

json::object dependency_json(const std::string& name, bool ready, const std::string& state,
                             const std::string& reason) {
  return {{"name", name},
          {"ready", ready},
          {"state", state},
          {"reason", reason.empty() ? json::value(nullptr) : json::value(reason)}};
}

/// Ready: what the daemon needs to do its work is there. A lost sensor or robot makes it not ready, never
/// dead.
Response answer_ready(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {"verbose"})) return problem(*unknown);
  const auto cell = service.cell();
  bool ready = cell.robot.link_state == "streaming";
  json::array dependencies{dependency_json("robot", ready, cell.robot.link_state, cell.robot.link_reason)};
  for (const auto& sensor : cell.sensors) {
    const bool streaming = sensor.health == "streaming";
    ready = ready && streaming;
    dependencies.push_back(dependency_json("sensor " + sensor.id, streaming, sensor.health, sensor.reason));
  }
  const auto& storage = cell.storage;
  ready = ready && storage.ready;
  dependencies.push_back(dependency_json("storage", storage.ready, storage.state, storage.reason));
  json::object body{{"ready", ready}};
  if (request.query.contains("verbose")) body["dependencies"] = std::move(dependencies);
  return json_response(ready ? 200 : 503, body);
}

}  // namespace

void add_health_routes(Router& router, CellService& service) {
  router.add("GET", "/livez", Cost::quick, [](const Request& request, const PathValues&) {
    if (auto unknown = unknown_query(request, {})) return problem(*unknown);
    return json_response(200, json::object{{"alive", true}});
  });
  router.add("GET", "/readyz", Cost::quick, [&service](const Request& request, const PathValues&) {
    return answer_ready(request, service);
  });
}

}  // namespace calibrd::api
