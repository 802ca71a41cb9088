// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>

#include "core/base/result.hpp"
#include "drivers/sim/controller/cycle.hpp"

namespace calibrd::sim {

/// The simulated robot controller: a TCP server on 127.0.0.1 that streams as MotoROS does. It sends from the
/// moment a client is there, one send() per message, never reads, holds four clients and throws out the one
/// in slot 0 for a fifth. As RTDE it reads, and sends what it is asked for. All calls and all work on the
/// thread that runs `io`, which must not run on after this object is gone.
class ControllerServer {
 public:
  using WorldSource = std::function<const WorldState&()>;
  enum class Farewell { fin, reset };

  ControllerServer(boost::asio::io_context& io, WorldSource world, const ControllerSettings& settings);
  ~ControllerServer();

  /// Listens on `port` (0: any free one) and starts the cycle. Errors: cannot_listen.
  Status listen(std::uint16_t port);
  std::uint16_t port() const { return port_; }

  const ControllerSettings& settings() const { return settings_; }
  /// Errors: cannot_listen, when the port is to be opened again and is taken.
  Status apply(const ControllerSettings& settings);
  void drop_clients(Farewell farewell);
  std::size_t client_count() const;
  void stop();

 private:
  struct Client;
  static constexpr std::size_t kSlots = 4;

  Status open_port();
  void accept_next();
  void admit(boost::asio::ip::tcp::socket socket);
  void wait_for_cycle();
  double cycle_hz() const;
  void cycle();
  void read_next(const std::shared_ptr<Client>& client);
  void enqueue(const std::shared_ptr<Client>& client, std::vector<Bytes> sends);
  void forget(const std::shared_ptr<Client>& client);
  void send_next(const std::shared_ptr<Client>& client);

  boost::asio::io_context& io_;
  WorldSource world_;
  ControllerSettings settings_;
  Frozen frozen_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  std::uint16_t port_ = 0;
  std::int64_t started_ns_ = 0;  // the controller's clock began when its port was opened
  std::uint64_t cycles_ = 0;
  std::array<std::shared_ptr<Client>, kSlots> slots_;
};

}  // namespace calibrd::sim
