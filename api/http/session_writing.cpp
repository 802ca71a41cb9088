// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What a session writes.
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/write.hpp>

#include "api/http/session.hpp"
#include "api/routes/responses.hpp"

namespace calibrd::api {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::size_t kReadAtOnce = 4096;
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

}  // namespace

asio::awaitable<void> Session::refuse() {
  request_id_ = context_.request_ids.next();
  auto refusal = problem(ApiError::too_many_connections);
  co_await write(std::move(refusal), false, false);
  co_await end_sending();
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
  while (!failure && !head && !context_.stopping && context_.door->still_admits(request, scope, peer_)) {
    const std::string text = co_await next_of(*response.stream);
    if (!text.empty()) {
      stream_.expires_after(context_.settings.write_timeout);
      co_await asio::async_write(stream_, asio::buffer(text),
                                 asio::redirect_error(asio::use_awaitable, failure));
      continue;
    }
    if (response.stream->has_ended()) break;
    pause.expires_after(response.stream->pause());
    co_await pause.async_wait(asio::use_awaitable);
  }
}

/// On a worker where it takes its time.
asio::awaitable<std::string> Session::next_of(BodyStream& stream) {
  if (!stream.is_slow()) co_return stream.next();
  auto work = [&stream]() -> asio::awaitable<std::string> { co_return stream.next(); };
  co_return co_await asio::co_spawn(context_.workers, std::move(work), asio::use_awaitable);
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
  co_await end_sending();
  beast::error_code failure;
  idle_ = true;
  stream_.expires_after(kDrainTime);
  std::size_t forgotten = 0;
  while (!failure && forgotten < kMostForgotten && !context_.stopping) {
    buffer_.clear();
    const auto space = buffer_.prepare(kReadAtOnce);
    const auto size =
        co_await stream_.tcp().async_read_some(space, asio::redirect_error(asio::use_awaitable, failure));
    forgotten += size;
  }
}

/// A client of TLS must hear that nothing more comes: it could not tell the end from an attack.
asio::awaitable<void> Session::end_sending() {
  beast::error_code failure;
  idle_ = true;
  if (stream_.has_tls()) {
    stream_.expires_after(kDrainTime);
    co_await stream_.async_shutdown(asio::redirect_error(asio::use_awaitable, failure));
  }
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, failure);
}

}  // namespace calibrd::api
