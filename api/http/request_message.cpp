// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/request_message.hpp"

#include <algorithm>
#include <boost/beast/http/error.hpp>
#include <cctype>

namespace calibrd::api {

namespace beast = boost::beast;
namespace http = beast::http;

void set_limits(RequestParser& parser, const HttpServerSettings& settings) {
  parser.header_limit(settings.header_limit);
  parser.body_limit(settings.body_limit);
}

std::optional<Request> request_of(const http::request<http::string_body>& message) {
  auto target = parse_target(message.target());
  if (!target) return std::nullopt;
  Request request{
      std::string(message.method_string()), std::move(target->first), std::move(target->second), {}, {}};
  for (const auto& field : message) {
    std::string name(field.name_string());
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    request.headers[name] = std::string(field.value());
  }
  return request;
}

std::optional<ApiError> problem_of(beast::error_code why) {
  if (why == http::error::header_limit) return ApiError::header_too_large;
  if (why == http::error::body_limit) return ApiError::body_too_large;
  const bool gone = why == http::error::end_of_stream || why == http::error::partial_message;
  if (!gone && why.category() == make_error_code(http::error::bad_method).category())
    return ApiError::bad_request;
  return std::nullopt;
}

}  // namespace calibrd::api
