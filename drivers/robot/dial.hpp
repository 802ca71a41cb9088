// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <system_error>
#include <utility>

#include "drivers/robot/name_lookup.hpp"
#include "drivers/robot/tcp_socket.hpp"

namespace calibrd {

/// Tries the endpoints from `index` on in turn, as dial() does.
template <class Guard, class Done>
void try_endpoints(boost::asio::ip::tcp::socket& socket, NameLookup::Endpoints endpoints, std::size_t index,
                   Guard guard, Done done) {
  const auto endpoint = endpoints[index];
  boost::system::error_code ignored;
  socket.close(ignored);
  auto connected = [&socket, endpoints = std::move(endpoints), index, guard,
                    done](boost::system::error_code failed) {
    if (!failed && connected_to_itself(socket)) failed = boost::asio::error::connection_refused;
    if (failed && index + 1 < endpoints.size())
      return try_endpoints(socket, endpoints, index + 1, guard, done);
    if (!failed) tune_state_socket(socket);
    done(failed);
  };
  socket.async_connect(endpoint, guard(std::move(connected)));
}

/// Looks the host up and connects `socket` to the first of its addresses that answers; then the socket is
/// tuned. Tells done(std::error_code). Knows no lock and no deadline: every completion handler goes through
/// guard(handler), which wraps it in the caller's lock, keeps `socket` alive, and drops it once the caller
/// has given up (lookup.cancel(), socket.close()).
template <class Guard, class Done>
void dial(NameLookup& lookup, boost::asio::ip::tcp::socket& socket, Guard guard, Done done) {
  lookup.start(
      guard([&socket, guard, done](const std::error_code& failed, const NameLookup::Endpoints& endpoints) {
        if (failed) return done(failed);
        try_endpoints(socket, endpoints, 0, guard, done);
      }));
}

}  // namespace calibrd
