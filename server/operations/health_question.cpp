// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/health_question.hpp"

#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <optional>

#include "server/operations/own_address.hpp"

namespace calibrd {
namespace {

namespace asio = boost::asio;
namespace ssl = asio::ssl;
namespace http = boost::beast::http;
namespace json = boost::json;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;
using SecureStream = ssl::stream<tcp::socket&>;

constexpr std::uint64_t kBodyLimit = 64 * 1024;

std::string in_seconds(std::chrono::milliseconds time) {
  auto text = std::to_string(std::chrono::duration<double>(time).count());
  text.erase(text.find_last_not_of('0') + 1);
  return text + (text.ends_with('.') ? "0 s" : " s");
}

/// A text of a JSON object; empty where there is none.
std::string value_in(const std::string& body, const char* key) {
  ErrorCode failure;
  const auto parsed = json::parse(body, failure);
  const auto* object = failure ? nullptr : parsed.if_object();
  const auto* value = object ? object->if_contains(key) : nullptr;
  return value && value->is_string() ? std::string(value->get_string()) : std::string();
}

HealthAnswer judge(const std::string& path, unsigned status, const std::string& body) {
  const bool asks_life = path == "/livez";
  if (status == 200) return {true, asks_life ? "alive" : "ready"};
  const auto text = value_in(body, status == 503 && asks_life ? "reason" : "detail");
  if (status == 503 && value_in(body, "code").empty())
    return {false, asks_life ? "not alive: " + text
                             : "not ready: robot, a sensor, the storage or a thread is missing; "
                               "/readyz?verbose says which"};
  return {false, "answered " + std::to_string(status) + (text.empty() ? "" : ": " + text)};
}

/// One question over one connection. Lives while the io_context runs; `answer` is what is known so far.
class Conversation {
 public:
  Conversation(asio::io_context& io, const HealthQuestion& question, HealthAnswer& answer)
      : question_(question), answer_(answer), socket_(io) {}

  // GCC 12 evaluates a co_await in a condition when it should not: each has a line of its own.
  asio::awaitable<void> run(tcp::endpoint peer, SecureStream* secure) {
    host_ = peer.address().is_v6() ? "[" + peer.address().to_string() + "]" : peer.address().to_string();
    ErrorCode failure;
    answer_.line = "no connection";
    co_await socket_.async_connect(peer, asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return fail("nothing listens there", failure);
    if (secure == nullptr) {
      co_await exchange(socket_);
      co_return;
    }
    answer_.line = "no handshake";
    co_await secure->async_handshake(ssl::stream_base::client,
                                     asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return fail_handshake(*secure, failure);
    co_await exchange(*secure);
  }

  tcp::socket& socket() { return socket_; }
  bool done() const { return done_; }

 private:
  void fail(const std::string& what, const ErrorCode& failure) {
    done_ = true;
    answer_ = {false, what + " (" + failure.message() + ")"};
  }

  void fail_handshake(SecureStream& secure, const ErrorCode& failure) {
    const long verdict = SSL_get_verify_result(secure.native_handle());
    if (verdict == X509_V_OK) return fail("no handshake", failure);
    done_ = true;
    answer_ = {false, std::string("its certificate is not believed (") +
                          X509_verify_cert_error_string(verdict) +
                          "); --ca takes the file of its authority, --name what it is for"};
  }

  template <class Stream>
  asio::awaitable<void> exchange(Stream& stream) {
    answer_.line = "no answer";
    http::request<http::empty_body> request{http::verb::get, question_.path, 11};
    request.set(http::field::host, host_);
    request.set(http::field::connection, "close");
    ErrorCode failure;
    co_await http::async_write(stream, request, asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return fail("the question could not be sent", failure);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> response;
    response.body_limit(kBodyLimit);
    co_await http::async_read(stream, buffer, response, asio::redirect_error(asio::use_awaitable, failure));
    if (failure) co_return fail(no_answer(), failure);
    done_ = true;
    answer_ = judge(question_.path, response.get().result_int(), response.get().body());
  }

  /// With TLS 1.3 a daemon turns a client without a certificate away only after the handshake.
  std::string no_answer() const {
    if (question_.tls && question_.certificate.empty())
      return "no whole answer came; where server.tls.client_ca is set, give --certificate and --key";
    return "no whole answer came; is server.tls as the running daemon has it?";
  }

  const HealthQuestion& question_;
  HealthAnswer& answer_;
  tcp::socket socket_;
  std::string host_;
  bool done_ = false;
};

/// Empty: the context is as the question wants it. Else: what is wrong with its files.
std::string prepare(ssl::context& context, const HealthQuestion& question) {
  ErrorCode failure;
  SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
  if (!question.ca.empty()) {
    context.load_verify_file(question.ca.string(), failure);
    if (failure) return question.ca.string() + " holds no certificate that can be read";
  }
  if (question.certificate.empty()) return {};
  context.use_certificate_chain_file(question.certificate.string(), failure);
  if (failure) return question.certificate.string() + " holds no certificate that can be read";
  context.use_private_key_file(question.key.string(), ssl::context::pem, failure);
  if (failure) return question.key.string() + " holds no key of that certificate that can be read";
  return {};
}

/// The loopback address is this machine's alone: who could answer there instead has the machine already.
std::string trust(SecureStream& secure, const HealthQuestion& question, const asio::ip::address& address) {
  if (question.ca.empty() && !address.is_loopback())
    return "on an address other than loopback its certificate must be verified; give its authority with --ca";
  if (question.ca.empty()) return {};
  const auto name = question.name.empty() ? address.to_string() : question.name;
  ErrorCode failure;
  secure.set_verify_mode(ssl::verify_peer, failure);
  if (!failure) secure.set_verify_callback(ssl::host_name_verification(name), failure);
  if (!failure && !question.name.empty()) SSL_set_tlsext_host_name(secure.native_handle(), name.c_str());
  return failure ? failure.message() : std::string();
}

/// At `peer`, with TLS or without; the answer is about that peer.
HealthAnswer ask(const HealthQuestion& question, const tcp::endpoint& peer) {
  HealthAnswer answer;
  ssl::context context(ssl::context::tls_client);
  if (auto wrong = prepare(context, question); !wrong.empty()) return {false, wrong};
  asio::io_context io;
  Conversation conversation(io, question, answer);
  std::optional<SecureStream> secure;
  if (question.tls) {
    secure.emplace(conversation.socket(), context);
    if (auto wrong = trust(*secure, question, peer.address()); !wrong.empty()) return {false, wrong};
  }
  asio::co_spawn(io, conversation.run(peer, secure ? &*secure : nullptr), asio::detached);
  io.run_for(question.within);
  if (conversation.done()) return answer;
  const HealthAnswer late{false, answer.line + " within " + in_seconds(question.within)};
  conversation.socket().close();  // ends what waits for it, so that nothing outlives what it refers to
  io.restart();
  io.run();
  return late;
}

}  // namespace

HealthAnswer ask_health(const HealthQuestion& question) {
  ErrorCode failure;
  const auto address = own_address(question.address, failure);
  if (failure) return {false, question.address + " is no IP address"};
  const tcp::endpoint peer(address, question.port);
  auto answer = ask(question, peer);
  const auto where = std::string(question.tls ? "https" : "http") + "://" +
                     (address.is_v6() ? "[" + address.to_string() + "]" : address.to_string()) + ":" +
                     std::to_string(question.port);
  answer.line = where + question.path + ": " + answer.line;
  return answer;
}

}  // namespace calibrd
