// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>

#include "api/http/door_settings.hpp"
#include "api/http/host_rules.hpp"
#include "api/http/rate_limiter.hpp"
#include "api/routes/message.hpp"

namespace calibrd::api {

/// The other end of a connection.
struct Peer {
  std::string address;   ///< as text
  std::string rate_key;  ///< whom its requests are counted for: an address, of IPv6 the network (/64)
  bool is_loopback = false;
  std::string certificate = {};  ///< name in the one it has shown; empty: none
};

/// Decides which requests come in, before a route sees them. One thread.
class Doorkeeper {
 public:
  explicit Doorkeeper(DoorSettings settings) : settings_(std::move(settings)), hosts_(settings_.hosts) {}

  /// The refusal of a request that needs `needed`; nothing when it may come in: then it knows its caller.
  std::optional<Response> refuse(Request& request, Scope needed, const Peer& peer,
                                 RateLimiter::Time now = std::chrono::steady_clock::now());

  /// Whether an answer that goes on may go on: tokens can be revoked meanwhile.
  bool still_admits(const Request& request, Scope needed, const Peer& peer) const;

 private:
  std::optional<Response> refuse_foreign(const Request& request) const;
  std::optional<Response> refuse_caller(Request& request, Scope needed, const Peer& peer) const;

  const DoorSettings settings_;
  const HostRules hosts_;
  RateLimiter rate_;
};

}  // namespace calibrd::api
