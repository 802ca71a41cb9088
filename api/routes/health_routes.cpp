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

std::string stalled_text(const std::vector<std::string>& stalled) {
  std::string names;
  for (const auto& name : stalled) names.append(names.empty() ? "" : ", ").append(name);
  return names.empty() ? names
                       : names + " has not gone on for ten seconds; send a support bundle and restart";
}

/// Alive: the threads that must go on do. Whoever watches the process restarts it otherwise.
Response answer_alive(const Request& request, const OperationsService& operations) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto stalled = operations.stalled_threads();
  json::object body{{"alive", stalled.empty()}};
  if (!stalled.empty()) body["reason"] = stalled_text(stalled);
  return json_response(stalled.empty() ? 200 : 503, body);
}

/// Ready: what the daemon needs to do its work is there. A lost sensor or robot makes it not ready, never
/// dead.
Response answer_ready(const Request& request, CellService& service, const OperationsService& operations) {
  if (auto unknown = unknown_query(request, {"verbose"})) return problem(*unknown);
  // Who only asks whether to send traffic needs no token; what is wrong with the cell is not for everybody.
  if (request.query.contains("verbose") && request.granted < Scope::read)
    return problem(request.headers.contains("authorization") ? ApiError::token_unknown
                                                             : ApiError::token_needed);
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
  const auto stalled = operations.stalled_threads();
  ready = ready && stalled.empty();
  dependencies.push_back(dependency_json("threads", stalled.empty(),
                                         stalled.empty() ? "progressing" : "stalled", stalled_text(stalled)));
  json::object body{{"ready", ready}};
  if (request.query.contains("verbose")) body["dependencies"] = std::move(dependencies);
  return json_response(ready ? 200 : 503, body);
}

}  // namespace

void add_health_routes(Router& router, CellService& service, const OperationsService& operations) {
  router.add(
      "GET", "/livez", Scope::open, Cost::quick,
      [&operations](const Request& request, const PathValues&) { return answer_alive(request, operations); });
  router.add("GET", "/readyz", Scope::open, Cost::quick,
             [&service, &operations](const Request& request, const PathValues&) {
               return answer_ready(request, service, operations);
             });
}

}  // namespace calibrd::api
