// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>

#include "core/base/result.hpp"
#include "drivers/sim/control/control_routes.hpp"

namespace calibrd::sim {

/// Serves ControlRoutes over HTTP on 127.0.0.1, on the thread that runs `io`. Stop `io` before this goes
/// away.
class ControlServer {
 public:
  ControlServer(boost::asio::io_context& io, ControlRoutes& routes) : routes_(routes), acceptor_(io) {}

  /// `port` 0: any free one. Errors: cannot_listen.
  Status listen(std::uint16_t port);
  std::uint16_t port() const { return port_; }

 private:
  ControlRoutes& routes_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::uint16_t port_ = 0;
};

}  // namespace calibrd::sim
