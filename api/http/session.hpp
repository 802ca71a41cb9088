// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include "api/http/connection.hpp"
#include "api/http/header_gate.hpp"
#include "api/http/http_server.hpp"
#include "api/http/peer.hpp"
#include "api/http/pending_answers.hpp"
#include "api/http/request_id.hpp"
#include "api/http/request_message.hpp"

namespace calibrd::api {

/// What all connections of a server share. Used on its network thread only.
struct SessionContext {
  const HttpServerSettings& settings;
  const Router& router;
  const std::function<void(const AccessRecord&)>& log;
  boost::asio::thread_pool& workers;
  std::shared_ptr<Doorkeeper> door;  ///< replaced by a reload
  HttpWatch& watch;
  PendingAnswers& pending;
  RequestIds request_ids = {};
  bool stopping = false;
};

/// One connection: reads requests and writes answers until either side ends it.
class Session {
 public:
  Session(boost::asio::ip::tcp::socket socket, std::shared_ptr<Tls> tls, SessionContext& context)
      : stream_(std::move(socket), std::move(tls)), peer_(peer_of(stream_.socket())), context_(context) {}

  boost::asio::awaitable<void> run();
  /// Answers 503 and closes: there are too many connections.
  boost::asio::awaitable<void> refuse();

  /// Ends the connection now if no request is under way, else after its answer.
  void end_when_idle();
  void close() { stream_.close(); }

 private:
  boost::asio::awaitable<bool> shake_hands();
  boost::asio::awaitable<bool> serve_one();
  boost::asio::awaitable<bool> await_request();
  boost::asio::awaitable<HeaderGate::Verdict> pass_header(HeaderGate& gate);
  boost::beast::error_code parse_header(const HeaderGate& gate, RequestParser& parser);
  boost::asio::awaitable<bool> serve(Request request, RequestParser& parser);
  boost::asio::awaitable<boost::beast::error_code> read_body(RequestParser& parser);
  boost::asio::awaitable<bool> answer(const Request& request, bool keep_alive);
  void log(const Request& request, const Response& response,
           std::chrono::steady_clock::time_point begin) const;
  boost::asio::awaitable<void> audit(const Request& request, const Response& response);
  boost::asio::awaitable<Response> dispatch(const Request& request);
  boost::asio::awaitable<Response> ask_again(const Request& request, Response response);
  boost::asio::awaitable<bool> write(Response response, bool head, bool keep_alive);
  boost::asio::awaitable<bool> send(std::string_view header, std::string_view body);
  boost::asio::awaitable<bool> send_rest(std::string_view header, std::string_view body, std::size_t sent);
  boost::asio::awaitable<std::string> next_of(BodyStream& stream);
  boost::asio::awaitable<void> write_stream(const Request& request, Response response);
  boost::asio::awaitable<void> end_with(Response response);
  boost::asio::awaitable<void> end_sending();

  /// Bytes that have come and are not parsed yet: no line of a chunked body may be longer.
  static constexpr std::size_t kMostBuffered = 128 * 1024;

  Connection stream_;
  Peer peer_;
  boost::beast::flat_buffer buffer_{kMostBuffered};
  SessionContext& context_;
  bool idle_ = true;
  bool has_asked_ = false;  // a request has come on this connection
  std::string request_id_;  // of the request being read or answered
};

}  // namespace calibrd::api
