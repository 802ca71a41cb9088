// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/cloud_response.hpp"

#include "api/problem/api_error.hpp"

namespace calibrd::api {

Result<CloudFormat> read_cloud_format(const Request& request) {
  const auto asked = request.query.find("format");
  if (asked == request.query.end()) return CloudFormat::ply;
  if (const auto format = cloud_format(asked->second)) return *format;
  return fail(ApiError::bad_query, "format: \"" + asked->second + "\" is none of ply, pcd, binary");
}

Response cloud_response(CloudFormat format, const CloudData& data,
                        std::vector<std::pair<std::string, std::string>> provenance) {
  std::vector<std::string> comments;
  for (const auto& [name, value] : provenance) comments.push_back(name + " " + value);
  auto file = write_cloud(format, data, comments);
  Response response{200, std::move(provenance), std::move(file.bytes)};
  response.headers.emplace_back("Content-Type", file.content_type);
  response.headers.emplace_back("Cache-Control", "no-store");
  response.headers.emplace_back("Calibrd-Points", std::to_string(data.points.size()));
  response.headers.emplace_back("Calibrd-Point-Bytes", std::to_string(file.point_bytes));
  response.headers.emplace_back("Calibrd-Fields", file.fields);
  return response;
}

}  // namespace calibrd::api
