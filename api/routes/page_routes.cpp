// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

/// The page is made of its own files alone and speaks to its own daemon alone. Pictures it draws itself are
/// data: and blob:.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
    "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kNoPage =
    "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>calibrd</title>\n"
    "<h1>calibrd</h1>\n<p>The daemon works, but its page was not built: Node.js was missing. "
    "Run scripts/setup.sh and build again.</p>\n<p><a href=\"/docs\">The HTTP interface</a></p>\n</html>\n";

constexpr const char* kForever = "public, max-age=31536000, immutable";  // a hash is part of the name
constexpr const char* kAskAgain = "no-cache";

/// RFC 9110, 12.5.3: gzip is named, and not with weight 0.
bool takes_gzip(const Request& request) {
  const std::string& accepted = request.header("accept-encoding");
  const auto at = accepted.find("gzip");
  if (at == std::string::npos) return false;
  const auto weight = accepted.substr(at + 4, accepted.find(',', at) - at - 4);
  return weight.find("q=0") == std::string::npos || weight.find("q=0.") != std::string::npos;
}

Response serve(const Request& request, const PageFile& file, const char* cache_control) {
  Response response{200,
                    {{"ETag", file.etag},
                     {"Cache-Control", cache_control},
                     {"Vary", "Accept-Encoding"},
                     {"Content-Security-Policy", kPagePolicy},
                     {"Referrer-Policy", "no-referrer"}},
                    {}};
  if (request.header("if-none-match") == file.etag) {
    response.status = 304;
    return response;
  }
  response.headers.emplace_back("Content-Type", file.content_type);
  const bool is_compressed = file.gzip && takes_gzip(request);
  if (is_compressed) response.headers.emplace_back("Content-Encoding", "gzip");
  response.body = is_compressed ? *file.gzip : file.bytes;
  return response;
}

Response answer_index(const Request& request, const PageFiles& files) {
  if (const auto* index = files.index()) return serve(request, *index, kAskAgain);
  return {200,
          {{"Content-Type", "text/html; charset=utf-8"},
           {"Cache-Control", "no-store"},
           {"Content-Security-Policy", kPagePolicy}},
          kNoPage};
}

Response answer_asset(const Request& request, const std::string& name, const PageFiles& files) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto* file = files.asset(name);
  return file ? serve(request, *file, kForever) : problem(ApiError::no_such_route, request.path);
}

}  // namespace

/// Open: a browser that asks for a page has no token. What the page shows it must ask for with one.
void add_page_routes(Router& router, std::shared_ptr<const PageFiles> files) {
  router.add("GET", "/", Scope::open, Cost::quick,
             [files](const Request& request, const PathValues&) { return answer_index(request, *files); });
  router.add("GET", "/assets/{file}", Scope::open, Cost::quick,
             [files](const Request& request, const PathValues& values) {
               return answer_asset(request, values[0], *files);
             });
}

}  // namespace calibrd::api
