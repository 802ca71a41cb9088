// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>

#include "core/base/result.hpp"
#include "drivers/sim/controller/controller_server.hpp"
#include "drivers/sim/controller/motion_commands.hpp"

namespace calibrd::sim {

/// The motion port of the simulated controller: a TCP server on 127.0.0.1 that takes MotoROS's commands, in
/// pieces of any size, and moves the robot. One client: a second one takes its place unless points are
/// queued, then it is turned away. Without a client the robot stops. One thread, as ControllerServer.
class MotionServer {
 public:
  struct WorldAccess {
    std::function<const WorldState&()> read;
    std::function<void(const WorldState&)> change;
  };

  MotionServer(boost::asio::io_context& io, WorldAccess world, ControllerServer& controller);
  ~MotionServer() { stop(); }

  /// Listens on `port` (0: any free one). Errors: cannot_listen.
  Status listen(std::uint16_t port);
  std::uint16_t port() const { return port_; }

  /// What the controller's settings no longer allow ends.
  void look_at_settings();

  std::size_t accepted() const { return accepted_; }  ///< connections since start
  bool has_client() const { return client_ != nullptr; }
  const MotionCommands& commands() const { return commands_; }
  void drop_client();
  void stop();

 private:
  struct Client;

  void accept_next();
  void admit(boost::asio::ip::tcp::socket socket);
  void read_next(const std::shared_ptr<Client>& client);
  void take(const std::shared_ptr<Client>& client);
  void answer(const std::shared_ptr<Client>& client, const Bytes& message);
  void send_next(const std::shared_ptr<Client>& client);
  void lose(const std::shared_ptr<Client>& client);
  void stop_robot();

  WorldAccess world_;
  ControllerServer& controller_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::uint16_t port_ = 0;
  std::size_t accepted_ = 0;
  std::shared_ptr<Client> client_;
  MotionCommands commands_;
};

}  // namespace calibrd::sim
