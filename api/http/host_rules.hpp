// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrd::api {

/// "cell7:8080" in its parts, in lower case.
struct Authority {
  std::string host;  ///< of an IPv6 address without its brackets
  std::string port;  ///< empty: that of the scheme
  bool operator==(const Authority&) const = default;
};

/// Nothing when it is no host name or address with an optional port.
std::optional<Authority> parse_authority(std::string_view text);

/// Which names this daemon answers to, and which pages may speak to it. A page of somebody else's site, in
/// the browser of somebody who can reach the cell, may ask under a name of its own that it has pointed at us
/// (DNS rebinding), or under ours with its own Origin.
class HostRules {
 public:
  /// `names`: besides those of the loopback and any IP address, which no foreign name can stand for. "*":
  /// all.
  explicit HostRules(std::vector<std::string> names);

  /// Of the Host header.
  bool is_ours(std::string_view host) const;
  /// Of the Origin header: a page we served under the name it asks for now, or under one of `names`.
  bool is_own_page(std::string_view origin, std::string_view host) const;

 private:
  bool is_named(const std::string& host) const;
  std::vector<std::string> names_;
};

}  // namespace calibrd::api
