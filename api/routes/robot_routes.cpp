// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/cell_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {

void add_robot_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/robot", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues&) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return json_response(200, robot_json(service.robot()));
             });
}

}  // namespace calibrd::api
