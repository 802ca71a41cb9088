// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/openapi/embedded.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

/// Open to all who may speak to the daemon: the document is that of every calibrd, and a browser that asks
/// for a page has no token. The page is made of its own files alone: nothing of other hosts, nothing inline,
/// and in nobody's frame.
constexpr const char* kDocsPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

void add_file(Router& router, const char* path, const char* content_type, std::string_view text) {
  router.add("GET", path, Scope::open, Cost::quick,
             [content_type, text](const Request& request, const PathValues&) -> Response {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return {200,
                       {{"Content-Type", content_type},
                        {"Cache-Control", "no-cache"},
                        {"Content-Security-Policy", kDocsPolicy}},
                       std::string(text)};
             });
}

}  // namespace

void add_openapi_routes(Router& router) {
  add_file(router, "/openapi.json", "application/json", embedded_openapi_json());
  add_file(router, "/docs", "text/html; charset=utf-8", embedded_docs_html());
  add_file(router, "/docs/docs.js", "text/javascript; charset=utf-8", embedded_docs_js());
  add_file(router, "/docs/docs.css", "text/css; charset=utf-8", embedded_docs_css());
}

}  // namespace calibrd::api
