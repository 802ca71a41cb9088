// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/exposure.hpp"

#include "server/security/security_error.hpp"

namespace calibrd {

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.") || address.starts_with("::ffff:127.");
}

Status check_exposure(const ServerConfig& server) {
  const bool asks = !server.tokens_file.empty() || !server.tls.client_ca.empty();
  if (is_loopback(server.address) || asks || server.allow_unauthenticated) return Done{};
  return Error{SecurityError::open_without_tokens, "server.address = \"" + server.address + "\""};
}

}  // namespace calibrd
