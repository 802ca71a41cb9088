// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>

#include "api/json/next_posture_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

constexpr double kHighestTable_m = 10;

Result<double> read_table_height(const Request& request) {
  const auto asked = request.query.find("table_height_m");
  if (asked == request.query.end()) return 0.0;
  const auto& text = asked->second;
  const auto* end = text.data() + text.size();
  double height_m = 0;
  const auto [rest, failure] = std::from_chars(text.data(), end, height_m);
  if (failure != std::errc() || rest != end || !(std::abs(height_m) <= kHighestTable_m))
    return fail(ApiError::bad_query, "table_height_m: \"" + text + "\" is not a height within 10 m");
  return height_m;
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
  router.add("GET", "/api/v1/sensors/{id}/next-posture", Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_next_posture(request, values, service);
             });
}

}  // namespace calibrd::api
