// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/next_posture_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"
#include "core/planning/table_height.hpp"

namespace calibrd::api {
namespace {

Result<double> read_table_height(const Request& request) {
  const auto asked = request.query.find("table_height_m");
  if (asked == request.query.end()) return 0.0;
  if (const auto height_m = parse_table_height(asked->second)) return *height_m;
  return fail(ApiError::bad_query, "table_height_m: " + not_a_table_height(asked->second));
}

Response answer_next_posture(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {"table_height_m"})) return problem(*unknown);
  const auto table_height_m = read_table_height(request);
  if (!table_height_m) return problem(table_height_m.error());
  const auto suggestion = service.next_posture({values[0], *table_height_m});
  return suggestion ? json_response(200, next_posture_object(*suggestion)) : problem(suggestion.error());
}

}  // namespace

void add_next_posture_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/sensors/{id}/next-posture", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_next_posture(request, values, service);
             });
}

}  // namespace calibrd::api
