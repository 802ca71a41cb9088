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

}  // namespace

asio::awaitable<void> Session::run() {
  while (!context_.stopping) {  // no && with co_await: GCC 12 evaluates the latter whatever the former says
    if (!co_await await_request()) break;
    RequestParser parser;
    request_id_ = context_.request_ids.next();
    const auto failure = co_await read(parser);
    if (failure) {
      co_await refuse_unreadable(failure);
      break;
    }
    if (!co_await answer(parser)) break;
  }
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

/// Reads the rest of the request: header and body each have a deadline in all, however slowly they trickle
/// in.
asio::awaitable<beast::error_code> Session::read(RequestParser& parser) {
  set_limits(parser, context_.settings);
  beast::error_code failure;
  stream_.expires_after(context_.settings.header_timeout);
  co_await http::async_read_header(stream_, buffer_, parser,
                                   asio::redirect_error(asio::use_awaitable, failure));
  if (failure) co_return failure;
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
asio::awaitable<bool> Session::answer(RequestParser& parser) {
  const auto begin = std::chrono::steady_clock::now();
  auto message = parser.release();
  const bool keep_alive = message.keep_alive() && !context_.stopping;
  const bool head = message.method() == http::verb::head;
  if (const auto id = message["X-Request-Id"]; is_request_id({id.data(), id.size()}))
    request_id_ = std::string(id);
  auto request = request_of(message);
  if (!request)
    co_return co_await write(problem(ApiError::bad_request, "the path cannot be decoded"), head, keep_alive);
  request->request_id = request_id_;
  stream_.expires_never();
  auto response = co_await dispatch(*request);
  if (response.worth_waiting.count() > 0) response = co_await ask_again(*request, std::move(response));
  log(*request, response, begin);
  if (!response.stream) co_return co_await write(std::move(response), head, keep_alive);
  co_await write_stream(std::move(response), head);
  co_return false;
}

void Session::log(const Request& request, const Response& response,
                  std::chrono::steady_clock::time_point begin) const {
  if (!context_.log) return;
  const LogScope scope({request.request_id, {}});
  const auto duration = std::chrono::steady_clock::now() - begin;
  context_.log({request.method, request.path, response.status, request.request_id, response.route,
                std::chrono::duration_cast<std::chrono::microseconds>(duration)});
}

/// Its end is that of the connection.
asio::awaitable<void> Session::write_stream(Response response, bool head) {
  auto message = heading<http::empty_body>(response, request_id_, false);
  stream_.expires_after(context_.settings.write_timeout);
  beast::error_code failure;
  co_await http::async_write(stream_, message, asio::redirect_error(asio::use_awaitable, failure));
  asio::steady_timer pause(stream_.get_executor());
  while (!failure && !head && !context_.stopping) {
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

asio::awaitable<void> Session::refuse_unreadable(beast::error_code why) {
  context_.watch.unreadable.add();
  if (const auto error = problem_of(why)) co_await write(problem(*error, why.message()), false, false);
}

}  // namespace calibrd::api
