// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ip/address.hpp>
#include <boost/system/error_code.hpp>
#include <string>

namespace calibrd {

/// Where a daemon that listens on `configured` is asked from its own machine: that of any interface stands
/// for this machine.
boost::asio::ip::address own_address(const std::string& configured, boost::system::error_code& failure);

}  // namespace calibrd
