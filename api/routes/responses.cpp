// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/responses.hpp"

#include <algorithm>
#include <boost/json/object.hpp>

#include "api/json/json_text.hpp"
#include "core/robot/nearest_name.hpp"

namespace calibrd::api {

namespace json = boost::json;

Response json_response(int status, const json::value& body) { return json_response(status, json_text(body)); }

Response json_response(int status, std::string text) {
  return {status, {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}}, std::move(text)};
}

Response problem(const Error& error) {
  const bool known = error.code.category() == api_category();
  const auto& entry = problem_entry(known ? static_cast<ApiError>(error.code.value()) : ApiError::internal);
  json::object body{{"type", std::string("urn:calibrd:problem:") + entry.code},
                    {"title", entry.title},
                    {"status", entry.status},
                    {"code", entry.code},
                    {"detail", known ? error.detail : error.message()},
                    {"remedy", entry.remedy}};
  Response response{entry.status,
                    {{"Content-Type", "application/problem+json"}, {"Cache-Control", "no-store"}},
                    json_text(body)};
  if (entry.status == 401)  // RFC 6750
    response.headers.emplace_back("WWW-Authenticate", error.code == ApiError::token_unknown
                                                          ? R"(Bearer realm="calibrd", error="invalid_token")"
                                                          : R"(Bearer realm="calibrd")");
  return response;
}

Response problem(ApiError error, std::string detail) { return problem(fail(error, std::move(detail))); }

Response archive_response(Result<CaptureArchive> archive) {
  if (!archive) return problem(archive.error());
  return {200,
          {{"Content-Type", "application/x-tar"},
           {"Content-Disposition", "attachment; filename=\"" + archive->file_name + "\""},
           {"Cache-Control", "no-store"}},
          std::move(archive->tar)};
}

std::optional<Error> unknown_query(const Request& request, std::initializer_list<std::string> known) {
  const std::vector<std::string> names(known);
  for (const auto& [name, unused] : request.query)
    if (std::find(names.begin(), names.end(), name) == names.end())
      return fail(ApiError::bad_query, name + (names.empty() ? "" : " (" + name_hint(name, names) + ")"));
  return std::nullopt;
}

}  // namespace calibrd::api
