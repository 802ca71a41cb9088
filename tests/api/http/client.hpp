// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <string>

namespace calibrd::api {

namespace asio = boost::asio;
namespace http = boost::beast::http;

/// A client that speaks the real bytes, blocking, with a deadline from the socket.
class Client {
 public:
  /// `window`: bytes that it takes before they are read; 0: as usual.
  explicit Client(std::uint16_t port, int window = 0) : socket_(io_, asio::ip::tcp::v4()) {
    if (window > 0) socket_.set_option(asio::socket_base::receive_buffer_size(window));
    socket_.connect({asio::ip::make_address("127.0.0.1"), port});
    const timeval deadline{10, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &deadline, sizeof deadline);
  }
  void send(std::string_view bytes) { asio::write(socket_, asio::buffer(bytes)); }
  http::response<http::string_body> receive(bool head = false) {
    http::response_parser<http::string_body> parser;
    parser.body_limit(boost::none);
    parser.skip(head);
    http::read(socket_, buffer_, parser);
    return parser.release();
  }
  http::response<http::string_body> get(const std::string& target) {
    send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return receive();
  }
  /// Of a body without an end, up to and with `end`.
  std::string receive_until(const std::string& end) {
    std::string text;
    asio::read_until(socket_, asio::dynamic_buffer(text), end);
    return text;
  }
  /// Whatever comes until the connection ends.
  std::string receive_all() {
    std::string text;
    boost::system::error_code end;
    asio::read(socket_, asio::dynamic_buffer(text), end);
    return text;
  }
  /// The next bytes, or fewer where the connection ends.
  std::string receive_some(std::size_t bytes) {
    std::string text(bytes, '\0');
    boost::system::error_code end;
    text.resize(asio::read(socket_, asio::buffer(text), end));
    return text;
  }
  bool is_closed() {
    char byte = 0;
    boost::system::error_code failure;
    socket_.read_some(asio::buffer(&byte, 1), failure);
    return failure == asio::error::eof || failure == asio::error::connection_reset;
  }

 private:
  asio::io_context io_;
  asio::ip::tcp::socket socket_;
  boost::beast::flat_buffer buffer_;
};

}  // namespace calibrd::api
