// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {

void add_operations_routes(Router& router, const OperationsService& operations) {
  router.add(
      "GET", "/metrics", Scope::read, Cost::quick,
      [&operations](const Request& request, const PathValues&) -> Response {
        if (auto unknown = unknown_query(request, {})) return problem(*unknown);
        return {200,
                {{"Content-Type", "text/plain; version=0.0.4; charset=utf-8"}, {"Cache-Control", "no-store"}},
                operations.metrics()};
      });
  router.add("GET", "/api/v1/support_bundle", Scope::admin, Cost::slow,
             [&operations](const Request& request, const PathValues&) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return archive_response(operations.support_bundle());
             });
}

}  // namespace calibrd::api
