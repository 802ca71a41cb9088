// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "api/json/pose_json.hpp"
#include "api/routes/names.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

double age_s(Clock::time_point stamp) { return std::chrono::duration<double>(Clock::now() - stamp).count(); }

json::array series_json(const std::vector<DriftSample>& series) {
  json::array list;
  for (const auto& sample : series)
    list.push_back({{"age_s", age_s(sample.stamp)},
                    {"statistic", sample.statistic},
                    {"shift_m", sample.shift_m},
                    {"turn_rad", sample.turn_rad},
                    {"depth_offset_change_m", sample.depth_offset_change_m}});
  return list;
}

json::array events_json(const std::vector<DriftEvent>& events) {
  json::array list;
  for (const auto& event : events)
    list.push_back({{"age_s", age_s(event.stamp)}, {"verdict", event.verdict}});
  return list;
}

json::object drift_json(const DriftReport& drift) {
  const auto& now = drift.now;
  json::object body{
      {"sensor", drift.sensor_id},
      {"pose_state", name_of(drift.pose_state)},
      {"watched", drift.watched},
      {"verdict", calibrd::name_of(now.verdict)},
      {"meaning", calibrd::text_of(now.verdict)},
      {"age_s", drift.age ? json::value(drift.age->count()) : json::value(nullptr)},
      {"statistic", now.statistic},
      {"threshold", now.threshold},
      {"shift",
       {{"position_m", now.shift_m},
        {"rotation_rad", now.turn_rad},
        {"sigma_position_m", now.shift_sigma_m},
        {"sigma_rotation_rad", now.turn_sigma_rad}}},
      {"depth_offset_change_m", now.depth_offset_change_m},
      {"background",
       {{"known", now.has_background},
        {"in_place", now.same},
        {"nearer", now.nearer},
        {"farther", now.farther},
        {"dark", now.dark}}},
      {"healing", drift.healing},
      {"healing_in_s", drift.healing_in ? json::value(drift.healing_in->count()) : json::value(nullptr)},
      {"candidate", drift.candidate.empty() ? json::value(nullptr) : json::value(drift.candidate)}};
  // Where it seems to be now is no pose to use: it has not been judged.
  body["T_base_sensor_seen"] =
      now.T_base_sensor_seen ? json::value(matrix_json(*now.T_base_sensor_seen)) : json::value(nullptr);
  body["series"] = series_json(drift.series);
  body["events"] = events_json(drift.events);
  return body;
}

}  // namespace

void add_drift_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/sensors/{id}/drift", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               const auto drift = service.drift(values[0]);
               return drift ? json_response(200, drift_json(*drift)) : problem(drift.error());
             });
}

}  // namespace calibrd::api
