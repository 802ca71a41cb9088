// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What a session writes.
#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http/status.hpp>

#include "api/http/session.hpp"
#include "api/routes/responses.hpp"

namespace calibrd::api {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::size_t kReadAtOnce = 4096;
constexpr std::size_t kSentAtOnce = 64 * 1024;
constexpr auto kDrainTime = std::chrono::seconds(1);
constexpr std::size_t kMostForgotten = 4 * 1024 * 1024;

/// A line break in a value would begin another header.
void append_header(std::string& text, const std::string& name, std::string value) {
  std::ranges::replace_if(
      value, [](unsigned char c) { return c < ' ' || c == 0x7F; }, ' ');
  text.append(name).append(": ").append(value).append("\r\n");
}

std::string heading(const Response& response, const std::string& request_id, bool keep_alive,
                    std::optional<std::size_t> length) {
  const auto reason = http::obsolete_reason(static_cast<http::status>(response.status));
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + " ";
  text.append(reason.data(), reason.size()).append("\r\n");
  for (const auto& [name, value] : response.headers) append_header(text, name, value);
  text.append("Server: calibrd\r\nX-Content-Type-Options: nosniff\r\nX-Request-Id: ").append(request_id);
  if (!keep_alive) text += "\r\nConnection: close";
  if (length) text.append("\r\nContent-Length: ").append(std::to_string(*length));
  return text += "\r\n\r\n";
}

/// The next bytes of header and body: few enough that a large answer does not keep the network thread from
/// the others.
std::array<asio::const_buffer, 2> next_part(std::string_view header, std::string_view body,
                                            std::size_t sent) {
  const auto of_header = header.substr(std::min(sent, header.size()));
  const auto of_body = body.substr(sent - std::min(sent, header.size()));
  return {asio::buffer(of_header), asio::buffer(of_body.substr(0, kSentAtOnce))};
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
  const auto header = heading(response, request_id_, false, std::nullopt);
  bool goes_on = co_await send(header, {});
  asio::steady_timer pause(stream_.get_executor());
  while (goes_on && !head && !context_.stopping && context_.door->still_admits(request, scope, peer_)) {
    const std::string text = co_await next_of(*response.stream);
    if (!text.empty()) {
      goes_on = co_await send({}, text);
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
  const std::string_view body = response.text();
  const auto length = bodiless ? std::nullopt : std::optional(body.size());
  const auto header = heading(response, request_id_, keep_alive, length);
  const auto sent_body = head || bodiless ? std::string_view() : body;
  const bool is_sent = co_await send(header, sent_body);
  co_return keep_alive&& is_sent;
}

/// Most answers go out in one piece, at once: no deadline, no turn of the network thread. False: the
/// connection has failed.
asio::awaitable<bool> Session::send(std::string_view header, std::string_view body) {
  std::size_t sent = 0;
  if (!stream_.has_tls()) {
    beast::error_code failure;
    const auto part = next_part(header, body, 0);
    sent = stream_.socket().write_some(part, failure);
    if (failure && failure != asio::error::would_block) co_return false;
  }
  if (sent == header.size() + body.size()) co_return true;
  stream_.drop_unsent_at_close(true);
  const bool is_sent = co_await send_rest(header, body, sent);
  if (is_sent)
    stream_.drop_unsent_at_close(false);
  else
    close();  // here, because a socket's destructor would leave what is unsent to the kernel
  co_return is_sent;
}

/// As the client takes it, with a deadline for each piece and one in all.
asio::awaitable<bool> Session::send_rest(std::string_view header, std::string_view body, std::size_t sent) {
  using Clock = std::chrono::steady_clock;
  const auto size = header.size() + body.size();
  const auto& settings = context_.settings;
  const auto deadline = Clock::now() + settings.write_timeout;
  const auto* const owner = body.empty() ? header.data() : body.data();
  PendingAnswers::Answer answer(context_.pending, owner, size, [this] { close(); });
  while (sent < size) {
    const auto left = deadline - Clock::now();
    if (left <= Clock::duration::zero()) co_return false;
    stream_.expires_after(std::min<Clock::duration>(settings.stall_timeout, left));
    beast::error_code failure;
    const auto part = next_part(header, body, sent);
    const auto taken =
        co_await stream_.async_write_some(part, asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return false;
    sent += taken;
    answer.note_progress();
  }
  co_return true;
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
