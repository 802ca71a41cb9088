// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/control/control_server.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>

#include "drivers/sim/controller/listen_on_loopback.hpp"

namespace calibrd::sim {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

namespace {

constexpr std::size_t kBodyLimit = 256 * 1024;
constexpr std::chrono::seconds kIdle{30};

http::response<http::string_body> respond(const http::request<http::string_body>& request,
                                          ControlRoutes& routes) {
  const ControlResponse answer =
      routes.handle({std::string(request.method_string()), std::string(request.target()), request.body()});
  http::response<http::string_body> response{http::int_to_status(answer.status), request.version()};
  response.set(http::field::content_type, "application/json");
  response.keep_alive(request.keep_alive());
  response.body() = answer.body + "\n";
  response.prepare_payload();
  return response;
}

asio::awaitable<void> serve(tcp::socket socket, ControlRoutes& routes) {
  beast::tcp_stream stream(std::move(socket));
  beast::flat_buffer buffer;
  boost::system::error_code failed;
  const auto token = [&failed] { return asio::redirect_error(asio::use_awaitable, failed); };
  for (bool alive = true; alive;) {
    http::request_parser<http::string_body> parser;
    parser.body_limit(kBodyLimit);
    stream.expires_after(kIdle);
    co_await http::async_read(stream, buffer, parser, token());
    if (failed) break;  // gone, silent for too long, or not HTTP
    auto response = respond(parser.get(), routes);
    alive = response.keep_alive();
    co_await http::async_write(stream, response, token());
    if (failed) break;
  }
  stream.socket().shutdown(tcp::socket::shutdown_send, failed);
}

asio::awaitable<void> accept_all(tcp::acceptor& acceptor, ControlRoutes& routes) {
  for (;;) {
    boost::system::error_code failed;
    tcp::socket socket = co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, failed));
    if (failed == asio::error::operation_aborted) co_return;
    if (!failed) asio::co_spawn(acceptor.get_executor(), serve(std::move(socket), routes), asio::detached);
  }
}

}  // namespace

Status ControlServer::listen(std::uint16_t port) {
  const auto listening = listen_on_loopback(acceptor_, "control port", port);
  if (!listening) return listening.error();
  port_ = *listening;
  asio::co_spawn(acceptor_.get_executor(), accept_all(acceptor_, routes_), asio::detached);
  return Done{};
}

}  // namespace calibrd::sim
