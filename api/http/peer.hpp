// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ip/tcp.hpp>

#include "api/http/doorkeeper.hpp"

namespace calibrd::api {

/// Who is at the other end of a connection. An IPv4 address in IPv6's clothes counts as what it is.
Peer peer_of(const boost::asio::ip::tcp::socket& socket);

}  // namespace calibrd::api
