// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/controller_server.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>

#include "drivers/sim/controller/listen_on_loopback.hpp"

namespace calibrd::sim {

namespace asio = boost::asio;
using asio::ip::tcp;

struct ControllerServer::Client {
  explicit Client(tcp::socket accepted) : socket(std::move(accepted)) {}
  tcp::socket socket;
  std::deque<Bytes> queue;  // the front is being sent
  std::optional<RtdeSession> session;
  std::array<std::uint8_t, 512> inbox{};
};

ControllerServer::ControllerServer(asio::io_context& io, WorldSource world,
                                   const ControllerSettings& settings)
    : io_(io), world_(std::move(world)), settings_(settings), acceptor_(io), timer_(io) {}

ControllerServer::~ControllerServer() { stop(); }

Status ControllerServer::listen(std::uint16_t port) {
  port_ = port;
  if (settings_.mode != ControllerSettings::Mode::refuse || port == 0) {
    if (auto opened = open_port(); !opened) return opened;
    if (settings_.mode == ControllerSettings::Mode::refuse)
      acceptor_.close();  // the port number is now known
  }
  wait_for_cycle();
  return Done{};
}

Status ControllerServer::open_port() {
  const auto listening = listen_on_loopback(acceptor_, "controller port", port_);
  if (!listening) return listening.error();
  port_ = *listening;
  started_ns_ = monotonic_ns();
  accept_next();
  return Done{};
}

void ControllerServer::accept_next() {
  acceptor_.async_accept([this](boost::system::error_code failed, tcp::socket socket) {
    if (failed == asio::error::operation_aborted) return;
    if (!failed) admit(std::move(socket));
    accept_next();
  });
}

void ControllerServer::admit(tcp::socket socket) {
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  auto slot = std::find(slots_.begin(), slots_.end(), nullptr);
  if (slot == slots_.end()) {
    slot = slots_.begin();  // as MotoROS does when no motion is queued
    (*slot)->socket.close(ignored);
  }
  *slot = std::make_shared<Client>(std::move(socket));
  if (settings_.protocol != ControllerSettings::Protocol::rtde) return;
  (*slot)->session.emplace();
  read_next(*slot);
}

void ControllerServer::read_next(const std::shared_ptr<Client>& client) {
  client->socket.async_read_some(asio::buffer(client->inbox), [this, client](boost::system::error_code failed,
                                                                             std::size_t size) {
    if (failed) return forget(client);
    const bool deaf = settings_.mode == ControllerSettings::Mode::silent;
    auto replies = deaf ? Bytes() : client->session->take(std::span(client->inbox).first(size), settings_);
    if (!replies) return forget(client);
    if (!replies->empty()) enqueue(client, {*std::move(replies)});
    read_next(client);
  });
}

void ControllerServer::wait_for_cycle() {
  timer_.expires_after(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / cycle_hz())));
  timer_.async_wait([this](boost::system::error_code failed) {
    if (failed == asio::error::operation_aborted) return;
    cycle();
    wait_for_cycle();  // the sleep comes after the sends, so the rate is a little below the nominal one
  });
}

double ControllerServer::cycle_hz() const {
  double fastest_hz = 0;
  for (const auto& client : slots_)
    if (client && client->session) fastest_hz = std::max(fastest_hz, client->session->frequency_hz());
  return fastest_hz > 0 ? fastest_hz : settings_.rate_hz;
}

void ControllerServer::cycle() {
  const std::int64_t now_ns = monotonic_ns();
  std::vector<Bytes> sends;
  RtdeState state;
  if (settings_.protocol == ControllerSettings::Protocol::rtde)
    state = rtde_state(world_(), settings_, frozen_, now_ns, started_ns_);
  else
    sends = controller_cycle(world_(), settings_, frozen_, now_ns, cycles_++);
  for (auto& client : slots_) {
    // Who does not take the last cycle's bytes gets no more on top: a real server would block in send().
    if (!client || !client->queue.empty()) continue;
    if (!client->session) {
      enqueue(client, sends);
    } else if (settings_.mode != ControllerSettings::Mode::silent) {
      if (Bytes data = client->session->data(state, settings_); !data.empty())
        enqueue(client, {std::move(data)});
    }
  }
}

void ControllerServer::enqueue(const std::shared_ptr<Client>& client, std::vector<Bytes> sends) {
  if (sends.empty()) return;
  const bool idle = client->queue.empty();
  std::move(sends.begin(), sends.end(), std::back_inserter(client->queue));
  if (idle) send_next(client);
}

void ControllerServer::forget(const std::shared_ptr<Client>& client) {
  boost::system::error_code ignored;
  client->socket.close(ignored);
  std::replace(slots_.begin(), slots_.end(), client, std::shared_ptr<Client>());
}

void ControllerServer::send_next(const std::shared_ptr<Client>& client) {
  asio::async_write(client->socket, asio::buffer(client->queue.front()),
                    [this, client](boost::system::error_code failed, std::size_t) {
                      if (failed) return forget(client);
                      client->queue.pop_front();
                      if (!client->queue.empty()) send_next(client);
                    });
}

Status ControllerServer::apply(const ControllerSettings& settings) {
  using Mode = ControllerSettings::Mode;
  if (settings.mode == Mode::frozen && settings_.mode != Mode::frozen)
    frozen_ = {reported_joints(world_(), settings_, monotonic_ns()), monotonic_ns()};
  const bool opens = settings.mode != Mode::refuse && !acceptor_.is_open();
  using Protocol = ControllerSettings::Protocol;
  const bool other_manners = (settings.protocol == Protocol::rtde) != (settings_.protocol == Protocol::rtde);
  settings_ = settings;
  if (other_manners) drop_clients(Farewell::fin);
  if (settings.mode == Mode::refuse) {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    drop_clients(Farewell::fin);
  }
  return opens ? open_port() : Status(Done{});
}

void ControllerServer::drop_clients(Farewell farewell) {
  boost::system::error_code ignored;
  for (auto& client : slots_) {
    if (!client) continue;
    if (farewell == Farewell::reset) client->socket.set_option(asio::socket_base::linger(true, 0), ignored);
    if (farewell == Farewell::fin) client->socket.shutdown(tcp::socket::shutdown_both, ignored);
    client->socket.close(ignored);
    client.reset();
  }
}

std::size_t ControllerServer::client_count() const {
  return static_cast<std::size_t>(
      std::count_if(slots_.begin(), slots_.end(), [](const auto& client) { return client != nullptr; }));
}

void ControllerServer::stop() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  timer_.cancel();
  drop_clients(Farewell::fin);
}

}  // namespace calibrd::sim
