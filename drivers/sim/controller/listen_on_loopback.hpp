// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <string>

#include "core/base/result.hpp"

namespace calibrd::sim {

/// Opens `acceptor` on 127.0.0.1; `port` 0: any free one. Returns the port. On failure the acceptor is
/// closed. Errors: cannot_listen, which calls the port by its `name`.
Result<std::uint16_t> listen_on_loopback(boost::asio::ip::tcp::acceptor& acceptor, const std::string& name,
                                         std::uint16_t port);

}  // namespace calibrd::sim
