// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/http_server.hpp"

#include <netinet/tcp.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>

#include "api/http/beating.hpp"
#include "api/http/doorkeeper.hpp"
#include "api/http/http_server_error.hpp"
#include "api/http/session.hpp"
#include "api/http/tls.hpp"
#include "core/base/thread_name.hpp"

namespace calibrd::api {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;

/// Refused connections that are being told so at a time; beyond it they are just closed.
constexpr std::size_t kMaxRefusals = 32;
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
/// Bytes of an answer that wait in the kernel until the client has room for them. Without a limit the kernel
/// takes megabytes for each of them, and the network thread spends its time on copying them.
constexpr int kMostUnsent = 128 * 1024;
using NotSentLowWater = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_NOTSENT_LOWAT>;
/// How long the kernel waits for a client to take any of what it still has, after a close as well (ms).
using UserTimeout = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_USER_TIMEOUT>;

}  // namespace

class HttpServer::Impl {
 public:
  Impl(const HttpServerSettings& settings, const Router& router, std::function<void(const AccessRecord&)> log,
       HttpWatch* watch)
      : settings_(settings),
        log_(std::move(log)),
        watch_(watch ? *watch : own_watch_),
        workers_(std::make_unique<asio::thread_pool>(static_cast<std::size_t>(settings.workers))),
        max_connections_(static_cast<std::size_t>(settings.max_connections)),
        pending_(settings.most_unread, watch_.unread_bytes),
        context_{settings_, router,  log_, *workers_, std::make_shared<Doorkeeper>(settings.door),
                 watch_,    pending_} {}

  ~Impl() {
    stop(std::chrono::milliseconds(0));
    // What waits in the workers holds on to sessions, and sessions hold on to io_: in this order.
    workers_.reset();
    sessions_.clear();
  }

  Status listen() {
    auto entrance = settings_.entrance;
    if (!entrance.address) {
      auto opened = HttpServer::open(settings_);
      if (!opened) return opened.error();
      entrance = *std::move(opened);
    }
    tls_ = std::move(entrance.tls);
    ErrorCode failure;
    acceptor_.assign(entrance.address->is_v6() ? tcp::v6() : tcp::v4(), entrance.address->release(), failure);
    set_options_of_connections();
    if (!failure) acceptor_.listen(asio::socket_base::max_listen_connections, failure);
    if (failure)
      return Error{HttpServerError::cannot_listen, settings_.address + " (" + failure.message() + ")"};
    port_ = acceptor_.local_endpoint(failure).port();
    return Done{};
  }

  Status apply(const HttpServerSettings& fresh) {
    auto tls = make_tls(fresh.tls);
    if (!tls) return tls.error();
    asio::post(io_, [this, most = fresh.max_connections, door = std::make_shared<Doorkeeper>(fresh.door),
                     shared = *std::move(tls)] {
      max_connections_ = static_cast<std::size_t>(most);
      context_.door = door;
      tls_ = shared;
    });
    return Done{};
  }

  void run() {
    asio::co_spawn(io_, accept_connections(), asio::detached);
    asio::co_spawn(io_, keep_beating(watch_.network_thread), asio::detached);
    thread_ = std::thread([this] {
      name_thread("http");
      io_.run();
    });
  }

  void stop(std::chrono::milliseconds grace) {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] { begin_stop(); });
    {
      std::unique_lock lock(mutex_);
      all_ended_.wait_for(lock, grace, [this] { return ended_; });
    }
    io_.stop();
    thread_.join();
    workers_->stop();
    workers_->join();
    for (auto& session : sessions_) session.close();  // those that did not end within the grace
  }

  std::uint16_t port() const { return port_; }

 private:
  /// They inherit them. They are served without, only not as well: failures are no matter.
  void set_options_of_connections() {
    ErrorCode ignored;
    acceptor_.set_option(tcp::no_delay(true), ignored);
    acceptor_.set_option(NotSentLowWater(kMostUnsent), ignored);
    acceptor_.set_option(UserTimeout(static_cast<int>(settings_.write_timeout.count())), ignored);
  }

  asio::awaitable<void> accept_connections() {
    for (;;) {
      ErrorCode failure;
      auto socket = co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, failure));
      if (context_.stopping) co_return;
      if (failure) {  // out of file descriptors, most likely: others end, then there is room again
        asio::steady_timer pause(io_, kAcceptPause);
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, failure));
        continue;
      }
      begin_session(std::move(socket));
    }
  }

  void begin_session(tcp::socket socket) {
    const bool serve = sessions_.size() < max_connections_;
    (serve ? watch_.accepted : watch_.refused).add();
    // To shake hands with those who are to be told costs more than serving them would.
    const bool is_told = !tls_ && sessions_.size() < max_connections_ + kMaxRefusals;
    if (!serve && !is_told) return;
    if (serve) watch_.connections.add(1);
    const auto session = sessions_.emplace(sessions_.end(), std::move(socket), tls_, context_);
    asio::co_spawn(io_, serve ? session->run() : session->refuse(),
                   [this, session, serve](const std::exception_ptr&) {
                     if (serve) watch_.connections.add(-1);
                     sessions_.erase(session);
                     note_end();
                   });
  }

  void begin_stop() {
    context_.stopping = true;
    ErrorCode ignored;
    acceptor_.close(ignored);
    for (auto& session : sessions_) session.end_when_idle();
    note_end();
  }

  void note_end() {
    if (!context_.stopping || !sessions_.empty()) return;
    const std::lock_guard lock(mutex_);
    ended_ = true;
    all_ended_.notify_all();
  }

  const HttpServerSettings settings_;
  const std::function<void(const AccessRecord&)> log_;
  HttpWatch own_watch_;  // where nobody else watches
  HttpWatch& watch_;
  std::unique_ptr<asio::thread_pool> workers_;
  std::size_t max_connections_;  // used on the network thread only, as what follows up to port_
  std::shared_ptr<Tls> tls_;     // null: plain HTTP
  PendingAnswers pending_;
  SessionContext context_;
  std::list<Session> sessions_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  std::uint16_t port_ = 0;
  std::thread thread_;

  std::mutex mutex_;
  std::condition_variable all_ended_;
  bool ended_ = false;  // guarded by mutex_
};

Result<std::unique_ptr<HttpServer>> HttpServer::start(const HttpServerSettings& settings,
                                                      const Router& router,
                                                      std::function<void(const AccessRecord&)> log,
                                                      HttpWatch* watch) {
  auto impl = std::make_unique<Impl>(settings, router, std::move(log), watch);
  if (auto status = impl->listen(); !status) return status.error();
  impl->run();
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(impl)));
}

Result<Entrance> HttpServer::open(const HttpServerSettings& settings) {
  auto tls = make_tls(settings.tls);
  if (!tls) return tls.error();
  auto address = BoundAddress::bind(settings.address, settings.port);
  if (!address) return address.error();
  return Entrance{*std::move(address), *std::move(tls)};
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() = default;
void HttpServer::stop(std::chrono::milliseconds grace) { impl_->stop(grace); }
Status HttpServer::apply(const HttpServerSettings& settings) { return impl_->apply(settings); }
std::uint16_t HttpServer::port() const { return impl_->port(); }

}  // namespace calibrd::api
