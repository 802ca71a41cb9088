// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <cmath>

#include "api/routes/cloud_response.hpp"
#include "api/routes/header_numbers.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"
#include "api/routes/shared_answers.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

/// What the cloud was made from, as name and value.
std::vector<std::pair<std::string, std::string>> provenance(const MergedCloud& cloud) {
  std::vector<std::pair<std::string, std::string>> lines{{"Calibrd-Frame", cloud.base_frame},
                                                         {"Calibrd-Depth", "corrected"}};
  for (std::size_t i = 0; i < cloud.parts.size(); ++i) {
    const auto& part = cloud.parts[i];
    const std::string name = "Calibrd-Sensor-" + std::to_string(i),
                      stamp = std::to_string(stamp_ns(part.stamp));
    lines.emplace_back(name, part.sensor_id);
    lines.emplace_back(name + "-Points", std::to_string(part.points));
    lines.emplace_back(name + "-Frame-Stamp-Ns", stamp);
    if (!part.joint_positions_rad.empty()) {
      lines.emplace_back(name + "-Joint-Stamp-Ns", stamp);
      lines.emplace_back(name + "-Joint-Positions", numbers_text(part.joint_positions_rad));
    }
    lines.emplace_back(name + "-Calibration", part.calibration_id);
    lines.emplace_back(name + "-T-Base-Sensor", pose_text(part.T_base_sensor));
  }
  for (const auto& left_out : cloud.left_out)
    lines.emplace_back("Calibrd-Left-Out", left_out.sensor_id + " " + left_out.code);
  return lines;
}

Response answer_merged_cloud(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {"robot", "format"})) return problem(*unknown);
  const auto robot = request.query.find("robot");
  const bool with_robot = robot == request.query.end() || robot->second == "true";
  if (!with_robot && robot->second != "false")
    return problem(ApiError::bad_query, "robot: \"" + robot->second + "\" is neither \"true\" nor \"false\"");
  const auto format = read_cloud_format(request);
  if (!format) return problem(format.error());
  const auto cloud = service.merged_cloud({with_robot});
  if (!cloud) return problem(cloud.error());
  std::vector<std::size_t> points_of_sensor;
  for (const auto& part : cloud->parts) points_of_sensor.push_back(part.points);
  return cloud_response(*format, {cloud->points, {}, points_of_sensor}, provenance(*cloud));
}

json::object pair_json(const SensorPair& pair) {
  const CrossCheck& check = pair.check;
  json::object body{{"first", pair.first_id}, {"second", pair.second_id}, {"compared", pair.compared}};
  if (!pair.compared) return body;
  body["overlap"] = check.has_overlap;
  body["pairs"] = check.pairs;
  if (!check.has_overlap) return body;
  body["agree"] = !check.disagrees();
  body["sigmas"] = std::isfinite(check.sigmas) ? json::value(check.sigmas) : json::value(nullptr);
  body["shift_m"] = check.shift_m;
  body["turn_rad"] = check.turn_rad;
  body["shift_sigma_m"] = std::sqrt(check.covariance.bottomRightCorner<3, 3>().trace());
  body["turn_sigma_rad"] = std::sqrt(check.covariance.topLeftCorner<3, 3>().trace());
  return body;
}

Response answer_cross_checks(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  json::array pairs;
  for (const auto& pair : service.cross_checks()) pairs.push_back(pair_json(pair));
  return json_response(200,
                       json::object{{"most_sigmas", CrossCheck::kMostSigmas}, {"pairs", std::move(pairs)}});
}

}  // namespace

void add_several_sensors_routes(Router& router, CellService& service) {
  router.add(
      "GET", "/api/v1/cell/cloud", Scope::read, Cost::slow,
      [&service, shared = std::make_shared<SharedAnswers>()](const Request& request, const PathValues&) {
        return shared->get(request, [&] { return answer_merged_cloud(request, service); });
      });
  router.add("GET", "/api/v1/cell/cross-checks", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues&) {
               return answer_cross_checks(request, service);
             });
}

}  // namespace calibrd::api
