// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <cmath>

#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"
#include "core/calibration/observability.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr double kMilli = 1000;  // of m and rad
constexpr const char* kMeaning =
    "from a to b, in axes of the base frame; displacement: where b puts what a puts at the point, minus the "
    "point";

json::array milli_json(const Eigen::Vector3d& v) { return {kMilli * v.x(), kMilli * v.y(), kMilli * v.z()}; }

/// Standard deviation of the difference of two independent figures; null where either is infinite.
json::value both_milli(double first, double second) {
  const double both = kMilli * std::hypot(first, second);
  return std::isfinite(both) ? json::value(both) : json::value(nullptr);
}

json::array workspace_json(const CalibrationResult& a, const CalibrationResult& b,
                           const std::vector<WorkspacePoint>& points) {
  const Pose T_base_moved = *b.T_base_sensor * a.T_base_sensor->inverse();  // a point by a to the same by b
  const auto of_a = workspace_errors(a.covariance, *a.T_base_sensor, points);
  const auto of_b = workspace_errors(b.covariance, *b.T_base_sensor, points);
  json::array list;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i].p_base;
    const Eigen::Vector3d displacement = T_base_moved * p - p;
    list.push_back({{"name", points[i].name},
                    {"point_m", json::array{p.x(), p.y(), p.z()}},
                    {"displacement_mm", milli_json(displacement)},
                    {"distance_mm", kMilli * displacement.norm()},
                    {"sigma_mm", both_milli(of_a.at(i).sigma_m, of_b.at(i).sigma_m)}});
  }
  return list;
}

Result<json::object> diff_json(const CalibrationReport& a, const CalibrationReport& b, CellService& service) {
  if (a.sensor_id != b.sensor_id)
    return fail(ApiError::not_comparable,
                a.id + " is of " + a.sensor_id + ", " + b.id + " of " + b.sensor_id);
  for (const auto* one : {&a, &b})
    if (!one->result || !one->result->T_base_sensor)
      return fail(ApiError::not_comparable, one->id + " has no pose");
  const auto pose = service.pose(a.sensor_id);
  if (!pose) return pose.error();
  const auto points = service.workspace(a.sensor_id);
  if (!points) return points.error();
  const Vector6d delta = difference(*a.result->T_base_sensor, *b.result->T_base_sensor);
  const Eigen::Vector3d turn = delta.head<3>(), shift = delta.tail<3>();
  return json::object{
      {"a", a.id},
      {"b", b.id},
      {"sensor", a.sensor_id},
      {"base_frame", pose->base_frame},
      {"meaning", kMeaning},
      {"translation_mm", milli_json(shift)},
      {"distance_mm", kMilli * shift.norm()},
      {"rotation_mrad", milli_json(turn)},
      {"angle_mrad", kMilli * turn.norm()},
      {"sigma_position_mm", both_milli(a.result->sigma_position_m, b.result->sigma_position_m)},
      {"sigma_rotation_mrad", both_milli(a.result->sigma_rotation_rad, b.result->sigma_rotation_rad)},
      {"workspace", workspace_json(*a.result, *b.result, *points)}};
}

Response answer_diff(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto a = service.calibration(values[0]);
  if (!a) return problem(a.error());
  const auto b = service.calibration(values[1]);
  if (!b) return problem(b.error());
  const auto body = diff_json(*a, *b, service);
  return body ? json_response(200, *body) : problem(body.error());
}

}  // namespace

void add_diff_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/calibrations/{a}/diff/{b}", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_diff(request, values, service);
             });
}

}  // namespace calibrd::api
