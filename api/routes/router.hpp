// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "api/access/scope.hpp"
#include "api/routes/message.hpp"

namespace calibrd::api {

/// What the {names} of a route's path stand for, in order.
using PathValues = std::vector<std::string>;

/// Quick: answers from memory. Slow: may wait for the disk, a render or the robot; never run on the network
/// thread.
enum class Cost { quick, slow };

struct Route {
  std::string method;
  std::vector<std::string> segments;  ///< {"api", "v1", "sensors", "{id}"}
  Scope scope;                        ///< what its clients must be allowed
  Cost cost;
  std::function<Response(const Request&, const PathValues&)> answer;
};

/// "/api/v1/sensors/{id}"
std::string path_of(const Route& route);

/// The table of routes. Filled once, then safe to read from any thread.
class Router {
 public:
  void add(std::string method, std::string_view path, Scope scope, Cost cost,
           std::function<Response(const Request&, const PathValues&)> answer);

  /// Answers any request: an unknown path is 404, a known path with another method 405 with Allow, HEAD as
  /// GET without the body, an exception 500.
  Response answer(const Request& request) const;

  Cost cost(const Request& request) const;

  /// In the order they were added.
  const std::vector<Route>& routes() const { return routes_; }
  /// What the client of this request must be allowed; to be told that there is no such route takes `read`.
  Scope scope(const Request& request) const;

 private:
  const Route* find(const std::string& method, const std::vector<std::string>& segments,
                    PathValues& values) const;
  Response without_route(const Request& request, const std::vector<std::string>& segments) const;

  std::vector<Route> routes_;
};

}  // namespace calibrd::api
