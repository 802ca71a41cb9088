// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "api/routes/cell_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

json::array sensors_json(const std::vector<SensorReport>& sensors) {
  json::array list;
  for (const auto& sensor : sensors) list.push_back(sensor_json(sensor));
  return list;
}

Response answer_sensors(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  return json_response(200, json::object{{"sensors", sensors_json(service.sensors())}});
}

Response answer_sensor(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto sensor = service.sensor(values[0]);
  return sensor ? json_response(200, sensor_json(*sensor)) : problem(sensor.error());
}

Response answer_cell(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto cell = service.cell();
  return json_response(200, json::object{{"version", cell.version},
                                         {"uptime_s", cell.uptime.count()},
                                         {"robot", robot_json(cell.robot)},
                                         {"sensors", sensors_json(cell.sensors)}});
}

}  // namespace

void add_sensor_routes(Router& router, CellService& service) {
  router.add(
      "GET", "/api/v1/sensors", Scope::read, Cost::quick,
      [&service](const Request& request, const PathValues&) { return answer_sensors(request, service); });
  router.add("GET", "/api/v1/sensors/{id}", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_sensor(request, values, service);
             });
  router.add("GET", "/api/v1/cell", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues&) { return answer_cell(request, service); });
}

}  // namespace calibrd::api
