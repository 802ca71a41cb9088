// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>

#include <boost/asio/async_result.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <memory>
#include <optional>
#include <string>

#include "api/http/tls.hpp"

namespace calibrd::api {

/// A connection with or without TLS, to be read from and written to as any other stream of Asio. Its
/// deadlines are those of the TCP stream below.
class Connection {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;

  /// `tls`: null for a plain connection.
  Connection(boost::asio::ip::tcp::socket socket, std::shared_ptr<Tls> tls)
      : tcp_(std::move(socket)), shared_(std::move(tls)) {
    boost::system::error_code ignored;
    tcp_.socket().non_blocking(true, ignored);  // what is written without waiting must not wait
    if (shared_) tls_.emplace(tcp_, shared_->context);
  }

  executor_type get_executor() { return tcp_.get_executor(); }
  boost::beast::tcp_stream& tcp() { return tcp_; }
  boost::asio::ip::tcp::socket& socket() { return tcp_.socket(); }
  void expires_after(std::chrono::nanoseconds time) { tcp_.expires_after(time); }
  void expires_never() { tcp_.expires_never(); }
  void close() { tcp_.close(); }
  /// Whether a close drops what the client has not taken and resets the connection. Otherwise the kernel
  /// keeps it for minutes after, for a client that may never read, and no limit here counts it.
  void drop_unsent_at_close(bool drop) {
    boost::system::error_code ignored;
    tcp_.socket().set_option(boost::asio::socket_base::linger(drop, 0), ignored);
  }
  /// The client has closed the connection, or its half of it. Nothing is read.
  bool has_left() {
    pollfd socket{tcp_.socket().native_handle(), POLLRDHUP, 0};
    return ::poll(&socket, 1, 0) > 0 && (socket.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
  }
  bool has_tls() const { return tls_.has_value(); }

  /// Only with TLS.
  template <class Token>
  auto async_handshake(Token&& token) {
    return tls_->async_handshake(boost::asio::ssl::stream_base::server, std::forward<Token>(token));
  }
  /// Only with TLS: tells the client that there is no more to come, and waits for it to say the same.
  template <class Token>
  auto async_shutdown(Token&& token) {
    return tls_->async_shutdown(std::forward<Token>(token));
  }

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, Signature>(
        [this](auto handler, const Buffers& into) {
          if (tls_)
            tls_->async_read_some(into, std::move(handler));
          else
            tcp_.async_read_some(into, std::move(handler));
        },
        token, buffers);
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, Signature>(
        [this](auto handler, const Buffers& from) {
          if (tls_)
            tls_->async_write_some(from, std::move(handler));
          else
            tcp_.async_write_some(from, std::move(handler));
        },
        token, buffers);
  }

  /// The common name of the client's certificate; empty where it has shown none.
  std::string client_name();

 private:
  using Signature = void(boost::system::error_code, std::size_t);

  boost::beast::tcp_stream tcp_;
  const std::shared_ptr<Tls> shared_;
  std::optional<boost::asio::ssl::stream<boost::beast::tcp_stream&>> tls_;
};

}  // namespace calibrd::api
