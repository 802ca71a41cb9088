// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/listen_on_loopback.hpp"

#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {

namespace asio = boost::asio;

Result<std::uint16_t> listen_on_loopback(asio::ip::tcp::acceptor& acceptor, const std::string& name,
                                         std::uint16_t port) {
  const asio::ip::tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
  boost::system::error_code failed;
  acceptor.open(endpoint.protocol(), failed);
  if (!failed) acceptor.set_option(asio::socket_base::reuse_address(true), failed);
  if (!failed) acceptor.bind(endpoint, failed);
  if (!failed) acceptor.listen(asio::socket_base::max_listen_connections, failed);
  if (!failed) return acceptor.local_endpoint().port();
  boost::system::error_code ignored;
  acceptor.close(ignored);
  return sim_error(SimError::cannot_listen,
                   name + " " + std::to_string(port) + " (" + failed.message() + ")");
}

}  // namespace calibrd::sim
