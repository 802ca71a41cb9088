// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace calibrd {

/// Looks one host name up. getaddrinfo() can block for many seconds and cannot be interrupted, so it runs on
/// a thread of its own that nobody waits for: neither cancel() nor the end of the executor is ever held up by
/// a dead DNS. Not thread-safe. cancel() before the executor's context ends; the destructor does.
class NameLookup {
 public:
  using Endpoints = std::vector<boost::asio::ip::tcp::endpoint>;
  using Handler = std::function<void(const std::error_code&, const Endpoints&)>;

  NameLookup(boost::asio::any_io_executor executor, std::string host, std::uint16_t port);
  ~NameLookup() { cancel(); }
  NameLookup(const NameLookup&) = delete;
  NameLookup& operator=(const NameLookup&) = delete;

  /// Calls `handler` on the executor with RobotLinkError::host_unknown or at least one endpoint. Addresses in
  /// numbers need no look-up. A call while an earlier look-up still blocks waits for that one's answer.
  void start(Handler handler);

  /// The handler of start() is not called any more, unless another thread is just calling it.
  void cancel();

 private:
  struct Shared;
  boost::asio::any_io_executor executor_;
  std::string host_;
  std::uint16_t port_;
  std::shared_ptr<Shared> shared_;
};

}  // namespace calibrd
