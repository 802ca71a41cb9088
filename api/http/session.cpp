// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/session.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>

#include "api/http/request_message.hpp"
#include "api/routes/responses.hpp"
#include "core/base/log_scope.hpp"

namespace calibrd::api {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::size_t kReadAtOnce = 4096;
constexpr auto kAskAgainAfter = std::chrono::milliseconds(50);

bool wants_continue(const http::request<http::string_body>& message) {
  return message.version() >= 11 && beast::iequals(message[http::field::expect], "100-continue");
}

/// Whatever is logged meanwhile names the request.
Response answer_marked(const Router& router, const Request& request) {
  const LogScope scope({request.request_id, {}});
  return router.answer(request);
}

/// The answer to a header that the parser would not have, or whose path cannot be decoded.
Response unreadable(beast::error_code failure) {
  if (!failure) return problem(ApiError::bad_request, "the path cannot be decoded");
  return problem(problem_of(failure).value_or(ApiError::bad_request));
}

bool may_change(const Request& request) {
  return request.method != "GET" && request.method != "HEAD" && request.method != "OPTIONS";
}

}  // namespace

asio::awaitable<void> Session::run() {
  // GCC 12 evaluates a co_await in a condition when it should not, and destroys twice what an argument of one
  // was made from in passing: in this file both have a line, and a name, of their own.
  bool goes_on = true;
  if (stream_.has_tls()) goes_on = co_await shake_hands();
  if (!goes_on) co_return;
  while (goes_on && !context_.stopping) goes_on = co_await serve_one();
  co_await end_sending();
}

/// With a deadline, as a header. False: the client shows no certificate it should, or speaks no TLS.
asio::awaitable<bool> Session::shake_hands() {
  beast::error_code failure;
  stream_.expires_after(context_.settings.header_timeout);
  co_await stream_.async_handshake(asio::redirect_error(asio::use_awaitable, failure));
  peer_.certificate = stream_.client_name();
  co_return !failure;
}

void Session::end_when_idle() {
  if (idle_) close();
}

/// Waits, patiently, for the first bytes of a request. False: the connection has ended.
asio::awaitable<bool> Session::await_request() {
  if (buffer_.size() > 0) co_return true;
  idle_ = true;
  // Who connects to ask for nothing holds a place that others want.
  stream_.expires_after(has_asked_ ? context_.settings.idle_timeout : context_.settings.header_timeout);
  beast::error_code failure;
  const auto space = buffer_.prepare(kReadAtOnce);
  const auto size =
      co_await stream_.async_read_some(space, asio::redirect_error(asio::use_awaitable, failure));
  buffer_.commit(size);
  idle_ = false;
  has_asked_ = true;
  co_return !failure && size > 0;
}

/// True: the connection goes on.
asio::awaitable<bool> Session::serve_one() {
  const bool has_come = co_await await_request();
  if (!has_come) co_return false;
  request_id_ = context_.request_ids.next();
  HeaderGate gate(context_.settings.header_limit);
  const auto verdict = co_await pass_header(gate);
  if (verdict != HeaderGate::Verdict::passed) context_.watch.unreadable.add();
  if (verdict == HeaderGate::Verdict::refused) {
    auto refusal = problem(gate.refusal());
    co_await end_with(std::move(refusal));
  }
  if (verdict != HeaderGate::Verdict::passed) co_return false;
  RequestParser parser;
  const auto failure = parse_header(gate, parser);
  auto request = failure ? std::nullopt : request_of(parser.get());
  if (!request) {
    context_.watch.unreadable.add();
    auto refusal = unreadable(failure);
    co_await end_with(std::move(refusal));
    co_return false;
  }
  if (is_request_id(request->header("x-request-id"))) request_id_ = request->header("x-request-id");
  request->request_id = request_id_;
  const bool goes_on = co_await serve(*std::move(request), parser);
  co_return goes_on;
}

/// Reads until the gate has decided, with a deadline in all, however slowly the bytes trickle in. Neither
/// passed nor refused: the client is gone, or too slow.
asio::awaitable<HeaderGate::Verdict> Session::pass_header(HeaderGate& gate) {
  stream_.expires_after(context_.settings.header_timeout);
  for (;;) {
    const auto come = buffer_.cdata();
    const auto verdict = gate.look({static_cast<const char*>(come.data()), come.size()});
    if (verdict != HeaderGate::Verdict::read_more) co_return verdict;
    beast::error_code failure;
    const auto space = buffer_.prepare(kReadAtOnce);
    const auto size =
        co_await stream_.async_read_some(space, asio::redirect_error(asio::use_awaitable, failure));
    buffer_.commit(size);
    if (failure) co_return HeaderGate::Verdict::read_more;
  }
}

beast::error_code Session::parse_header(const HeaderGate& gate, RequestParser& parser) {
  set_limits(parser, context_.settings);
  beast::error_code failure;
  buffer_.consume(parser.put(asio::buffer(buffer_.cdata().data(), gate.size()), failure));
  if (!failure && !parser.is_header_done()) failure = http::error::bad_field;
  return failure;
}

/// True: the connection goes on. A body is read only of a request that may come in.
asio::awaitable<bool> Session::serve(Request request, RequestParser& parser) {
  const auto begin = std::chrono::steady_clock::now();
  const bool keep_alive = parser.get().keep_alive() && !context_.stopping;
  auto refusal = context_.door->refuse(request, context_.router.scope(request), peer_);
  if (refusal) {
    log(request, *refusal, begin);
    bool goes_on = false;
    if (parser.is_done())
      goes_on = co_await write(*std::move(refusal), request.method == "HEAD", keep_alive);
    else
      co_await end_with(*std::move(refusal));
    co_return goes_on;
  }
  if (!parser.is_done()) {
    const auto failure = co_await read_body(parser);
    if (failure) context_.watch.unreadable.add();
    const auto why = problem_of(failure);
    if (why) {
      auto refusal = problem(*why);
      co_await end_with(std::move(refusal));
    }
    if (failure) co_return false;
    request.body = std::move(parser.get().body());
  }
  const bool goes_on = co_await answer(request, keep_alive);
  co_return goes_on;
}

/// With a deadline in all, as the header.
asio::awaitable<beast::error_code> Session::read_body(RequestParser& parser) {
  beast::error_code failure;
  stream_.expires_after(context_.settings.body_timeout);
  if (wants_continue(parser.get())) {
    http::response<http::empty_body> go_on{http::status::continue_, 11};
    co_await http::async_write(stream_, go_on, asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return failure;
  }
  co_await http::async_read(stream_, buffer_, parser, asio::redirect_error(asio::use_awaitable, failure));
  co_return failure;
}

/// True: the connection goes on.
asio::awaitable<bool> Session::answer(const Request& request, bool keep_alive) {
  const auto begin = std::chrono::steady_clock::now();
  stream_.expires_never();
  auto response = co_await dispatch(request);
  if (response.worth_waiting.count() > 0) response = co_await ask_again(request, std::move(response));
  const bool is_audited = context_.settings.audit && may_change(request);
  if (is_audited) co_await audit(request, response);
  log(request, response, begin);
  if (!response.stream) {
    const bool goes_on = co_await write(std::move(response), request.method == "HEAD", keep_alive);
    co_return goes_on;
  }
  co_await write_stream(request, std::move(response));
  co_return false;
}

void Session::log(const Request& request, const Response& response,
                  std::chrono::steady_clock::time_point begin) const {
  if (!context_.log) return;
  const LogScope scope({request.request_id, {}});
  const auto duration = std::chrono::steady_clock::now() - begin;
  context_.log({request.method, request.path, response.status, request.request_id, response.route,
                peer_.address, std::chrono::duration_cast<std::chrono::microseconds>(duration)});
}

/// On a worker: it waits for the disk.
asio::awaitable<void> Session::audit(const Request& request, const Response& response) {
  AuditRecord record{
      request.caller, peer_.address, request.request_id, request.method, request.path, response.status, {}};
  for (const auto& [name, value] : response.headers)
    if (name == "Location") record.location = value;
  auto work = [&write = context_.settings.audit, &record]() -> asio::awaitable<void> {
    write(record);
    co_return;
  };
  co_await asio::co_spawn(context_.workers, std::move(work), asio::use_awaitable);
}

asio::awaitable<Response> Session::dispatch(const Request& request) {
  if (context_.router.cost(request) == Cost::quick) co_return answer_marked(context_.router, request);
  auto work = [&router = context_.router, &request]() -> asio::awaitable<Response> {
    co_return answer_marked(router, request);
  };
  co_return co_await asio::co_spawn(context_.workers, std::move(work), asio::use_awaitable);
}

/// Routes hold no connection: waiting for a change is asking again, at a pace a client does not notice. Who
/// has left, as a client with less patience than it asked for, or may no longer know, is not waited for.
asio::awaitable<Response> Session::ask_again(const Request& request, Response response) {
  const auto deadline = std::chrono::steady_clock::now() + response.worth_waiting;
  asio::steady_timer pause(stream_.get_executor());
  const auto scope = context_.router.scope(request);
  while (response.worth_waiting.count() > 0 && !context_.stopping && !stream_.has_left() &&
         context_.door->still_admits(request, scope, peer_) && std::chrono::steady_clock::now() < deadline) {
    pause.expires_after(kAskAgainAfter);
    co_await pause.async_wait(asio::use_awaitable);
    response = co_await dispatch(request);
  }
  co_return response;
}

}  // namespace calibrd::api
