// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/motion_server.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <exception>

#include "drivers/sim/controller/listen_on_loopback.hpp"

namespace calibrd::sim {

namespace asio = boost::asio;
using asio::ip::tcp;

struct MotionServer::Client {
  explicit Client(tcp::socket accepted) : socket(std::move(accepted)) {}
  tcp::socket socket;
  std::array<std::uint8_t, 2048> piece{};
  Bytes received;           // not yet a whole message
  std::deque<Bytes> queue;  // the front is being sent
};

MotionServer::MotionServer(asio::io_context& io, WorldAccess world, ControllerServer& controller)
    : world_(std::move(world)), controller_(controller), acceptor_(io) {}

Status MotionServer::listen(std::uint16_t port) {
  const auto listening = listen_on_loopback(acceptor_, "motion port", port);
  if (!listening) return listening.error();
  port_ = *listening;
  accept_next();
  return Done{};
}

void MotionServer::accept_next() {
  acceptor_.async_accept([this](boost::system::error_code failed, tcp::socket socket) {
    if (failed == asio::error::operation_aborted) return;
    if (!failed) admit(std::move(socket));
    accept_next();
  });
}

void MotionServer::admit(tcp::socket socket) {
  ++accepted_;
  if (client_ && has_queue(world_.read(), monotonic_ns())) return;  // the newcomer is turned away
  drop_client();
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  client_ = std::make_shared<Client>(std::move(socket));
  read_next(client_);
}

void MotionServer::read_next(const std::shared_ptr<Client>& client) {
  client->socket.async_read_some(asio::buffer(client->piece),
                                 [this, client](boost::system::error_code failed, std::size_t size) {
                                   if (failed) return lose(client);
                                   const auto* begin = client->piece.data();
                                   client->received.insert(client->received.end(), begin, begin + size);
                                   take(client);
                                 });
}

void MotionServer::take(const std::shared_ptr<Client>& client) {
  const ByteOrder order = controller_.settings().big_endian != 0 ? ByteOrder::big : ByteOrder::little;
  try {
    while (const auto message = cut_message(order, client->received)) answer(client, *message);
  } catch (const std::exception&) {
    return lose(client);
  }
  if (client == client_) read_next(client);
}

void MotionServer::answer(const std::shared_ptr<Client>& client, const Bytes& message) {
  constexpr std::int32_t kInvalid = 3, kWrongType = 3003;
  ControllerSettings settings = controller_.settings();
  const ByteOrder order = settings.big_endian != 0 ? ByteOrder::big : ByteOrder::little;
  MotionCommands::Answer answer{{0, 0, 0, kInvalid, kWrongType}, false};
  if (const auto request = read_motion_request(order, message)) {
    WorldState world = world_.read();
    answer = commands_.obey(*request, world, settings, monotonic_ns());
    world_.change(world);
    if (const auto applied = controller_.apply(settings); !applied) return lose(client);
  }
  if (answer.hangs_up) return lose(client);
  client->queue.push_back(motion_reply_message(order, answer.reply));
  if (client->queue.size() == 1) send_next(client);
}

void MotionServer::send_next(const std::shared_ptr<Client>& client) {
  asio::async_write(client->socket, asio::buffer(client->queue.front()),
                    [this, client](boost::system::error_code failed, std::size_t) {
                      if (failed) return lose(client);
                      client->queue.pop_front();
                      if (!client->queue.empty()) send_next(client);
                    });
}

void MotionServer::lose(const std::shared_ptr<Client>& client) {
  if (client == client_) drop_client();
}

void MotionServer::drop_client() {
  if (!client_) return;
  boost::system::error_code ignored;
  client_->socket.close(ignored);
  client_.reset();
  stop_robot();
}

void MotionServer::look_at_settings() {
  if (not_ready_subcode(world_.read(), controller_.settings(), monotonic_ns()) != 0) stop_robot();
}

void MotionServer::stop_robot() {
  const std::int64_t now_ns = monotonic_ns();
  if (!has_queue(world_.read(), now_ns)) return;
  WorldState world = world_.read();
  world.motion.commanded.stop(now_ns);
  world_.change(world);
}

void MotionServer::stop() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  drop_client();
}

}  // namespace calibrd::sim
