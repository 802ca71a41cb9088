// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/object.hpp>

#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {

/// What whoever asks may do, so that a page offers no more than that. Open: without a token, or with one that
/// is not known, the answer is that nothing is allowed.
void add_session_routes(Router& router) {
  router.add("GET", "/api/v1/session", Scope::open, Cost::quick,
             [](const Request& request, const PathValues&) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return json_response(
                   200, boost::json::object{{"caller", request.caller}, {"scope", name_of(request.granted)}});
             });
}

}  // namespace calibrd::api
