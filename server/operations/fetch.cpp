// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/fetch.hpp"

#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "server/operations/own_address.hpp"

namespace calibrd {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using ErrorCode = boost::system::error_code;

constexpr timeval kPatience{30, 0};

Error unreachable(const std::string& why) { return {std::make_error_code(std::errc::host_unreachable), why}; }

}  // namespace

Result<std::string> fetch(const std::string& address, std::uint16_t port, const std::string& path,
                          const std::string& token) {
  ErrorCode failure;
  const auto host = own_address(address, failure);
  if (failure) return unreachable(address + ": " + failure.message());
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({host, port}, failure);
  if (failure) return unreachable(host.to_string() + ":" + std::to_string(port) + ": " + failure.message());
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience);
  http::request<http::empty_body> request{http::verb::get, path, 11};
  request.set(http::field::host, host.is_v6() ? "[" + host.to_string() + "]" : host.to_string());
  if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
  request.set(http::field::connection, "close");
  http::write(socket, request, failure);
  if (failure) return unreachable("the request could not be sent: " + failure.message());
  boost::beast::flat_buffer buffer;
  http::response_parser<http::string_body> response;
  response.body_limit(boost::none);
  http::read(socket, buffer, response, failure);
  if (failure) return unreachable("no whole answer came: " + failure.message());
  if (response.get().result() != http::status::ok)
    return unreachable(path + " was answered " + std::to_string(response.get().result_int()));
  return std::move(response.get().body());
}

}  // namespace calibrd
