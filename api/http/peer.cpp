// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/peer.hpp"

namespace calibrd::api {

namespace ip = boost::asio::ip;

Peer peer_of(const ip::tcp::socket& socket) {
  boost::system::error_code failure;
  auto address = socket.remote_endpoint(failure).address();
  if (failure) return {};  // gone already
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    address = ip::make_address_v4(ip::v4_mapped, address.to_v6());
  if (address.is_loopback()) return {address.to_string(), "loopback", true};
  if (address.is_v4()) return {address.to_string(), address.to_string(), false};
  auto network = address.to_v6().to_bytes();
  std::fill(network.begin() + 8, network.end(), 0);
  return {address.to_string(), ip::make_address_v6(network).to_string(), false};
}

}  // namespace calibrd::api
