// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/doorkeeper.hpp"

#include <algorithm>
#include <cctype>

#include "api/problem/api_error.hpp"
#include "api/routes/responses.hpp"

namespace calibrd::api {
namespace {

/// The token of "Bearer TOKEN" (RFC 6750); nothing where the header holds something else.
std::optional<std::string_view> bearer_token(std::string_view header) {
  constexpr std::string_view kScheme = "bearer";
  const bool is_bearer =
      header.size() > kScheme.size() && header[kScheme.size()] == ' ' &&
      std::equal(kScheme.begin(), kScheme.end(), header.begin(),
                 [](char a, unsigned char b) { return a == static_cast<char>(std::tolower(b)); });
  if (!is_bearer) return std::nullopt;
  header.remove_prefix(kScheme.size());
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

Response scope_too_small(const Caller& caller, Scope needed) {
  const std::string wanted = name_of(needed);
  auto response =
      problem(ApiError::scope_too_small, "token " + caller.name + " has the scope " + name_of(caller.scope) +
                                             ", " + wanted + " is needed");
  response.headers.emplace_back(
      "WWW-Authenticate", R"(Bearer realm="calibrd", error="insufficient_scope", scope=")" + wanted + '"');
  return response;
}

}  // namespace

std::optional<Response> Doorkeeper::refuse(Request& request, Scope needed, const Peer& peer,
                                           RateLimiter::Time now) {
  const int limit = peer.is_loopback ? settings_.loopback_rate_limit : settings_.rate_limit;
  if (!rate_.take(peer.rate_key, limit, now)) {
    auto response = problem(ApiError::too_many_requests, std::to_string(limit) + " requests per second");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  if (auto refusal = refuse_foreign(request)) return refusal;
  return refuse_caller(request, needed, peer);
}

std::optional<Response> Doorkeeper::refuse_foreign(const Request& request) const {
  const auto& host = request.header("host");
  if (!hosts_.is_ours(host)) return problem(ApiError::wrong_host, host);
  const auto& origin = request.header("origin");
  if (request.headers.contains("origin") && !hosts_.is_own_page(origin, host))
    return problem(ApiError::wrong_origin);
  // Browsers send no Origin with a picture or a script of another site; a link that is followed is no harm.
  if (request.header("sec-fetch-site") == "cross-site" && request.header("sec-fetch-mode") != "navigate")
    return problem(ApiError::wrong_origin);
  return std::nullopt;
}

std::optional<Response> Doorkeeper::refuse_caller(Request& request, Scope needed, const Peer& peer) const {
  request.caller = peer.certificate.empty() ? "local" : "cert:" + peer.certificate;
  request.granted = Scope::admin;
  if (!settings_.authenticator) return std::nullopt;
  request.caller.clear();
  request.granted = Scope::open;
  const bool is_open = needed == Scope::open;
  if (!request.headers.contains("authorization")) {
    if (is_open) return std::nullopt;
    return problem(ApiError::token_needed);
  }
  const auto token = bearer_token(request.header("authorization"));
  auto caller = token ? settings_.authenticator->find(*token) : std::nullopt;
  if (!caller) {
    if (is_open) return std::nullopt;
    return problem(ApiError::token_unknown);
  }
  if (caller->scope < needed) return scope_too_small(*caller, needed);
  request.granted = caller->scope;
  request.caller = std::move(caller->name);
  return std::nullopt;
}

bool Doorkeeper::still_admits(const Request& request, Scope needed, const Peer& peer) const {
  Request again{request.method, {}, {}, {{"authorization", request.header("authorization")}}, {}};
  return !refuse_caller(again, needed, peer);
}

}  // namespace calibrd::api
