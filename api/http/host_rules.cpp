// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/host_rules.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace calibrd::api {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

bool is_address(const std::string& host) {
  std::array<unsigned char, 16> bytes{};
  return inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

bool is_port(std::string_view text) {
  constexpr int kMost = 65535;
  if (text.empty() || text.size() > 5) return false;
  int port = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return false;
    port = port * 10 + (c - '0');
  }
  return port <= kMost;
}

bool is_name(std::string_view host) {
  constexpr std::size_t kLongest = 253;
  return !host.empty() && host.size() <= kLongest &&
         std::all_of(host.begin(), host.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '.' || c == '_'; });
}

std::string without_default_port(const Authority& authority, bool is_https) {
  return authority.port == (is_https ? "443" : "80") ? std::string() : authority.port;
}

}  // namespace

std::optional<Authority> parse_authority(std::string_view text) {
  Authority authority;
  const bool is_bracketed = !text.empty() && text.front() == '[';
  const auto host_end = is_bracketed ? text.find(']') : std::min(text.find(':'), text.size());
  if (host_end == std::string_view::npos) return std::nullopt;
  authority.host = lower_case(is_bracketed ? text.substr(1, host_end - 1) : text.substr(0, host_end));
  const auto rest = text.substr(is_bracketed ? host_end + 1 : host_end);
  if (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1)))) return std::nullopt;
  if (!rest.empty()) authority.port = rest.substr(1);
  if (is_bracketed ? !is_address(authority.host) : !is_name(authority.host)) return std::nullopt;
  return authority;
}

HostRules::HostRules(std::vector<std::string> names) : names_(std::move(names)) {
  for (auto& name : names_) name = lower_case(name);
}

bool HostRules::is_named(const std::string& host) const {
  return std::find(names_.begin(), names_.end(), host) != names_.end();
}

bool HostRules::is_ours(std::string_view host) const {
  auto authority = parse_authority(host);
  if (!authority) return false;
  if (authority->host.back() == '.') authority->host.pop_back();
  return authority->host == "localhost" || is_address(authority->host) || is_named(authority->host) ||
         is_named("*");
}

bool HostRules::is_own_page(std::string_view origin, std::string_view host) const {
  const bool is_https = origin.starts_with("https://");
  if (!is_https && !origin.starts_with("http://")) return false;  // "null", too
  const auto page = parse_authority(origin.substr(is_https ? 8 : 7));
  const auto here = parse_authority(host);
  if (!page || !here) return false;
  const bool is_same = page->host == here->host &&
                       without_default_port(*page, is_https) == without_default_port(*here, is_https);
  return is_same || is_named(page->host);
}

}  // namespace calibrd::api
