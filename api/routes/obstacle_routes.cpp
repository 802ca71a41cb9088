// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/value_from.hpp>
#include <cmath>

#include "api/json/pose_json.hpp"
#include "api/routes/header_numbers.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr const char* kNotice =
    "Information, not a safety function: it can miss things and be late. Nothing that protects people may "
    "depend on it.";

json::array point_json(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

json::value robot_distance_json(const Obstacle& obstacle, const std::vector<std::string>& links) {
  if (obstacle.link < 0 || !std::isfinite(obstacle.distance_m)) return nullptr;
  return json::object{{"distance_m", obstacle.distance_m},
                      {"link", links.at(static_cast<std::size_t>(obstacle.link))},
                      {"point_m", point_json(obstacle.nearest_base)},
                      {"robot_point_m", point_json(obstacle.nearest_robot_base)}};
}

json::object obstacle_json(const Obstacle& obstacle, const std::vector<std::string>& links) {
  return {
      {"centre_m", point_json(obstacle.centre_base)},
      {"box_m", {{"min", point_json(obstacle.box_base.min())}, {"max", point_json(obstacle.box_base.max())}}},
      {"points", obstacle.points},
      {"before_known_share", obstacle.before_known_share},
      {"near_tool", obstacle.near_tool},
      {"robot", robot_distance_json(obstacle, links)}};
}

json::object sensor_obstacles_json(const SensorObstacles& sensor, const std::vector<std::string>& links) {
  json::object body{{"sensor", sensor.sensor_id}, {"looked", sensor.code.empty()}};
  if (!sensor.code.empty()) {
    body["code"] = sensor.code;
    body["reason"] = sensor.reason;
  }
  if (sensor.stamp) {
    body["frame_stamp_ns"] = stamp_ns(*sensor.stamp);
    body["joint_stamp_ns"] =
        sensor.joint_positions_rad.empty() ? json::value(nullptr) : json::value(stamp_ns(*sensor.stamp));
    body["joint_positions_rad"] = json::value_from(sensor.joint_positions_rad);
    body["age_s"] = sensor.age.count();
  }
  if (sensor.T_base_sensor) {
    body["calibration"] = sensor.calibration_id;
    body["T_base_sensor"] = matrix_json(*sensor.T_base_sensor);
  }
  json::array obstacles;
  for (const auto& obstacle : sensor.obstacles) obstacles.push_back(obstacle_json(obstacle, links));
  body["obstacles"] = std::move(obstacles);
  return body;
}

Response answer_obstacles(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {"sensor"})) return problem(*unknown);
  const auto asked = request.query.find("sensor");
  if (asked != request.query.end() && asked->second.empty())
    return problem(ApiError::bad_query, "sensor: the id of a sensor is wanted");
  const auto report = service.obstacles(asked == request.query.end() ? std::string() : asked->second);
  if (!report) return problem(report.error());
  json::array sensors;
  for (const auto& sensor : report->sensors) sensors.push_back(sensor_obstacles_json(sensor, report->links));
  return json_response(200, json::object{{"safety_function", false},
                                         {"notice", kNotice},
                                         {"base_frame", report->base_frame},
                                         {"unit", "m"},
                                         {"sensors", std::move(sensors)}});
}

}  // namespace

void add_obstacle_routes(Router& router, CellService& service) {
  router.add(
      "GET", "/api/v1/cell/obstacles", Scope::read, Cost::slow,
      [&service](const Request& request, const PathValues&) { return answer_obstacles(request, service); });
}

}  // namespace calibrd::api
