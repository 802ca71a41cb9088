// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/router.hpp"

#include <exception>

#include "api/routes/responses.hpp"

namespace calibrd::api {
namespace {

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> segments;
  std::size_t at = 1;
  while (at <= path.size()) {
    const auto slash = std::min(path.find('/', at), path.size());
    segments.emplace_back(path.substr(at, slash - at));
    at = slash + 1;
  }
  return segments;
}

bool matches(const Route& route, const std::vector<std::string>& segments, PathValues& values) {
  if (route.segments.size() != segments.size()) return false;
  values.clear();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (route.segments[i].starts_with('{'))
      values.push_back(segments[i]);
    else if (route.segments[i] != segments[i])
      return false;
  }
  return true;
}

/// HEAD is asked for as GET; the server leaves the body away.
const std::string& effective_method(const Request& request) {
  static const std::string get = "GET";
  return request.method == "HEAD" ? get : request.method;
}

}  // namespace

std::string path_of(const Route& route) {
  std::string path;
  for (const auto& segment : route.segments) path.append("/").append(segment);
  return path;
}

void Router::add(std::string method, std::string_view path, Scope scope, Cost cost,
                 std::function<Response(const Request&, const PathValues&)> answer) {
  routes_.push_back({std::move(method), split(path), scope, cost, std::move(answer)});
}

const Route* Router::find(const std::string& method, const std::vector<std::string>& segments,
                          PathValues& values) const {
  for (const auto& route : routes_)
    if (route.method == method && matches(route, segments, values)) return &route;
  return nullptr;
}

Response Router::answer(const Request& request) const {
  const auto segments = split(request.path);
  PathValues values;
  const auto* route = find(effective_method(request), segments, values);
  if (!route) return without_route(request, segments);
  Response response;
  try {
    response = route->answer(request, values);
  } catch (const std::exception& failure) {
    response = problem(ApiError::internal, failure.what());
  }
  response.route = static_cast<int>(route - routes_.data());
  return response;
}

Cost Router::cost(const Request& request) const {
  PathValues values;
  const auto* route = find(effective_method(request), split(request.path), values);
  return route ? route->cost : Cost::quick;
}

Scope Router::scope(const Request& request) const {
  PathValues values;
  const auto* route = find(effective_method(request), split(request.path), values);
  return route ? route->scope : Scope::read;
}

Response Router::without_route(const Request& request, const std::vector<std::string>& segments) const {
  std::string allowed;
  PathValues values;
  for (const auto& route : routes_) {
    if (!matches(route, segments, values)) continue;
    if (!allowed.empty()) allowed += ", ";
    allowed += route.method;
    if (route.method == "GET") allowed += ", HEAD";
  }
  if (allowed.empty()) return problem(ApiError::no_such_route, request.path);
  if (request.method == "OPTIONS") return {204, {{"Allow", allowed + ", OPTIONS"}}, {}};
  auto response = problem(ApiError::method_not_allowed, request.method + " " + request.path);
  response.headers.emplace_back("Allow", allowed + ", OPTIONS");
  return response;
}

}  // namespace calibrd::api
