// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/bound_address.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <utility>

#include "api/http/http_server_error.hpp"

namespace calibrd::api {
namespace {

namespace asio = boost::asio;
using ErrorCode = boost::system::error_code;

Error translated(const ErrorCode& why, const std::string& where) {
  if (why == asio::error::address_in_use) return {HttpServerError::port_in_use, where};
  if (why == asio::error::access_denied) return {HttpServerError::not_allowed, where};
  if (why == boost::system::errc::address_not_available) return {HttpServerError::bad_address, where};
  return {HttpServerError::cannot_listen, where + " (" + why.message() + ")"};
}

ErrorCode last_failure() { return {errno, boost::system::system_category()}; }

}  // namespace

Result<std::shared_ptr<BoundAddress>> BoundAddress::bind(const std::string& text, std::uint16_t port) {
  const auto where = text + ":" + std::to_string(port);
  ErrorCode failure;
  const auto address = asio::ip::make_address(text, failure);
  if (failure) return Error{HttpServerError::bad_address, where};
  const asio::ip::tcp::endpoint endpoint(address, port);
  const int socket = ::socket(endpoint.protocol().family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return translated(last_failure(), where);
  std::shared_ptr<BoundAddress> bound(new BoundAddress(socket, address.is_v6()));
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket, endpoint.data(), static_cast<socklen_t>(endpoint.size())) != 0)
    return translated(last_failure(), where);
  return bound;
}

BoundAddress::~BoundAddress() {
  if (socket_ >= 0) ::close(socket_);
}

int BoundAddress::release() { return std::exchange(socket_, -1); }

}  // namespace calibrd::api
