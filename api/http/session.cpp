// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/session.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
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
constexpr auto kDrainTime = std::chrono::seconds(1);
constexpr std::size_t kMostForgotten = 4 * 1024 * 1024;

template <class Body>
http::response<Body> heading(const Response& response, const std::string& request_id, bool keep_alive) {
  http::response<Body> message{static_cast<http::status>(response.status), 11};
  for (const auto& [name, value] : response.headers) message.insert(name, value);
  message.set(http::field::server, "calibrd");
  message.set("X-Content-Type-Options", "nosniff");
  message.set("X-Request-Id", request_id);
  message.keep_alive(keep_alive);
  return message;
}

bool wants_continue(const http::request<http::string_body>& message) {
  return message.version() >= 11 && beast::iequals(message[http::field::expect], "100-continue");
}

/// Whatever is logged meanwhile names the request.
Response answer_marked(const Router& router, const Request& request) {
  const LogScope scope({request.request_id, {}});
  return router.answer(request);
}

bool may_change(const Request& request) {
  return request.method != "GET" && request.method != "HEAD" && request.method != "OPTIONS";
}

}  // namespace

asio::awaitable<void> Session::run() {
  bool goes_on = true;  // GCC 12 miscompiles co_await within a condition
  while (goes_on && !context_.stopping) goes_on = co_await serve_one();
  beast::error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
}

asio::awaitable<void> Session::refuse() {
  request_id_ = context_.request_ids.next();
  co_await write(problem(ApiError::too_many_connections), false, false);
  beast::error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
}

void Session::end_when_idle() {
  if (idle_) close();
}

/// Waits, patiently, for the first bytes of a request. False: the connection has ended.
asio::awaitable<bool> Session::await_request() {
  if (buffer_.size() > 0) co_return true;
  idle_ = true;
  stream_.expires_after(context_.settings.idle_timeout);
  beast::error_code failure;
  const auto space = buffer_.prepare(kReadAtOnce);
  const auto size =
      co_await stream_.async_read_some(space, asio::redirect_error(asio::use_awaitable, failure));
  buffer_.commit(size);
  idle_ = false;
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
  if (verdict == HeaderGate::Verdict::refused) co_await end_with(problem(gate.refusal()));
  if (verdict != HeaderGate::Verdict::passed) co_return false;
  RequestParser parser;
  const auto failure = parse_header(gate, parser);
  auto request = failure ? std::nullopt : request_of(parser.get());
  if (!request) {
    context_.watch.unreadable.add();
    const auto why = failure ? problem_of(failure).value_or(ApiError::bad_request) : ApiError::bad_request;
    co_await end_with(problem(why, failure ? std::string() : "the path cannot be decoded"));
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
  auto refusal = context_.door.refuse(request, context_.router.scope(request), peer_);
  if (refusal) {
    log(request, *refusal, begin);
    const bool is_whole = parser.is_done();
    if (is_whole) co_return co_await write(*std::move(refusal), request.method == "HEAD", keep_alive);
    co_await end_with(*std::move(refusal));
    co_return false;
  }
  if (!parser.is_done()) {
    const auto failure = co_await read_body(parser);
    if (failure) context_.watch.unreadable.add();
    const auto why = problem_of(failure);
    if (why) co_await end_with(problem(*why));
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
  if (context_.settings.audit && may_change(request)) co_await audit(request, response);
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

/// Its end is that of the connection.
asio::awaitable<void> Session::write_stream(const Request& request, Response response) {
  const bool head = request.method == "HEAD";
  const auto scope = context_.router.scope(request);
  auto message = heading<http::empty_body>(response, request_id_, false);
  stream_.expires_after(context_.settings.write_timeout);
  beast::error_code failure;
  co_await http::async_write(stream_, message, asio::redirect_error(asio::use_awaitable, failure));
  asio::steady_timer pause(stream_.get_executor());
  while (!failure && !head && !context_.stopping && context_.door.still_admits(request, scope)) {
    const std::string text = response.stream->next();
    if (!text.empty()) {
      stream_.expires_after(context_.settings.write_timeout);
      co_await asio::async_write(stream_, asio::buffer(text),
                                 asio::redirect_error(asio::use_awaitable, failure));
      continue;
    }
    pause.expires_after(kAskAgainAfter);
    co_await pause.async_wait(asio::use_awaitable);
  }
}

asio::awaitable<Response> Session::dispatch(const Request& request) {
  if (context_.router.cost(request) == Cost::quick) co_return answer_marked(context_.router, request);
  auto work = [&router = context_.router, &request]() -> asio::awaitable<Response> {
    co_return answer_marked(router, request);
  };
  co_return co_await asio::co_spawn(context_.workers, std::move(work), asio::use_awaitable);
}

/// Routes hold no connection: waiting for a change is asking again, at a pace a client does not notice.
asio::awaitable<Response> Session::ask_again(const Request& request, Response response) {
  const auto deadline = std::chrono::steady_clock::now() + response.worth_waiting;
  asio::steady_timer pause(stream_.get_executor());
  while (response.worth_waiting.count() > 0 && !context_.stopping &&
         std::chrono::steady_clock::now() < deadline) {
    pause.expires_after(kAskAgainAfter);
    co_await pause.async_wait(asio::use_awaitable);
    response = co_await dispatch(request);
  }
  co_return response;
}

asio::awaitable<bool> Session::write(Response response, bool head, bool keep_alive) {
  const bool bodiless = response.status == 204 || response.status == 304;
  stream_.expires_after(context_.settings.write_timeout);
  beast::error_code failure;
  if (head || bodiless) {
    auto message = heading<http::empty_body>(response, request_id_, keep_alive);
    if (!bodiless) message.content_length(response.body.size());
    co_await http::async_write(stream_, message, asio::redirect_error(asio::use_awaitable, failure));
  } else {
    auto message = heading<http::string_body>(response, request_id_, keep_alive);
    message.body() = std::move(response.body);
    message.prepare_payload();
    co_await http::async_write(stream_, message, asio::redirect_error(asio::use_awaitable, failure));
  }
  co_return keep_alive && !failure;
}

/// Answers and ends the connection. Closed with bytes unread it would be reset, and the answer be lost with
/// it; so what still comes is read and forgotten, for a moment.
asio::awaitable<void> Session::end_with(Response response) {
  co_await write(std::move(response), false, false);
  beast::error_code failure;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, failure);
  idle_ = true;
  stream_.expires_after(kDrainTime);
  std::size_t forgotten = 0;
  while (!failure && forgotten < kMostForgotten && !context_.stopping) {
    buffer_.clear();
    const auto space = buffer_.prepare(kReadAtOnce);
    const auto size =
        co_await stream_.async_read_some(space, asio::redirect_error(asio::use_awaitable, failure));
    forgotten += size;
  }
}

}  // namespace calibrd::api
