// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/result.hpp"

namespace calibrd::api {

/// A TCP address that belongs to this process and that nobody listens to yet: to be taken while there still
/// is the right to, and connections to be refused until a server is ready.
class BoundAddress {
 public:
  /// Errors: HttpServerError, the detail naming address and port.
  static Result<std::shared_ptr<BoundAddress>> bind(const std::string& address, std::uint16_t port);
  ~BoundAddress();
  BoundAddress(const BoundAddress&) = delete;

  /// The socket, once; it is the caller's from now on.
  int release();
  bool is_v6() const { return is_v6_; }

 private:
  BoundAddress(int socket, bool is_v6) : socket_(socket), is_v6_(is_v6) {}
  int socket_;
  const bool is_v6_;
};

}  // namespace calibrd::api
