// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/own_address.hpp"

namespace calibrd {

namespace ip = boost::asio::ip;

ip::address own_address(const std::string& configured, boost::system::error_code& failure) {
  const auto address = ip::make_address(configured, failure);
  if (failure || !address.is_unspecified()) return address;
  if (address.is_v6()) return ip::address_v6::loopback();
  return ip::address_v4::loopback();
}

}  // namespace calibrd
