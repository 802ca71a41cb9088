// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/robot/link_machine.hpp"
#include "drivers/robot/name_lookup.hpp"

namespace calibrd {

/// Carries out what a LinkMachine decides: one TCP connection, one timer. Knows no protocol.
/// Thread-safe. Must be owned by a shared_ptr; stop() it before the executor's context ends.
class LinkShell : public std::enable_shared_from_this<LinkShell> {
 public:
  LinkShell(const boost::asio::any_io_executor& executor, const std::string& host, std::uint16_t port,
            LinkMachine machine, RobotLinkEvents events);

  void start();

  /// Closes at once; no event after it returns. Waits for an event that is being delivered on another thread,
  /// so do not hold a lock that an event's handler takes. May be called from a handler, and more than once.
  void stop();

  /// The latest health with its counters. Never blocks on a handler.
  RobotLinkHealth health() const;

 private:
  using Tcp = boost::asio::ip::tcp;
  using ErrorCode = boost::system::error_code;

  void obey(const LinkSteps& steps);
  void carry_out(link_step::Connect);
  void carry_out(link_step::Close);
  void carry_out(const link_step::Send& send);
  void carry_out(const link_step::ArmTimer& timer);
  void carry_out(const link_step::DeliverJoints& delivery);
  void carry_out(const link_step::DeliverStatus& delivery);
  void carry_out(const link_step::ReportHealth& report);

  template <class Handler>
  auto for_this_connection(Handler handler);
  template <class Work>
  void carefully(Work work);
  void start_over(const char* what);
  void wait_for_bytes();
  void read_what_is_there();
  bool read_once();
  void write_outbox();

  // Guards what follows up to health_mutex_ and serialises the events. Recursive because a handler may call
  // stop().
  std::recursive_mutex mutex_;
  Tcp::socket socket_;
  boost::asio::steady_timer timer_;
  NameLookup lookup_;
  LinkMachine machine_;
  RobotLinkEvents events_;
  std::uint64_t connection_ = 0;  // counts attempts and closes: completions of an earlier one are ignored
  std::uint64_t timer_round_ = 0;
  Clock::time_point last_stamp_{};
  Clock::time_point drained_at_{};  // then nothing was waiting to be read: what came since came later
  std::array<std::byte, std::size_t{16} * 1024> inbox_{};
  std::vector<std::byte> outbox_;
  std::shared_ptr<std::vector<std::byte>> leaving_;
  bool stopped_ = false;

  mutable std::mutex health_mutex_;  // of its own, so that health() never waits for a handler
  RobotLinkHealth health_;           // guarded by health_mutex_
};

}  // namespace calibrd
