// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/any_io_executor.hpp>
#include <memory>

#include "core/base/result.hpp"
#include "drivers/robot/joint_source.hpp"
#include "drivers/robot/state_client_settings.hpp"

namespace calibrd {

class LinkShell;

/// Reads joints and status of one controller, as settings.driver says, and keeps the link up: one connection
/// at a time, to the state port only. Nothing that could command the robot is ever sent: over simple_message
/// no byte, over RTDE the requests to be told its state. Linux. Thread-safe. stop() or destroy it before the
/// executor's context ends.
class StateClient {
 public:
  /// Checks the settings, opens nothing. `events` are called on `executor`, one at a time.
  /// Errors: RobotLinkError, detail names the key.
  static Result<StateClient> create(const boost::asio::any_io_executor& executor,
                                    const StateClientSettings& settings, RobotLinkEvents events);

  StateClient(StateClient&&) noexcept;
  StateClient& operator=(StateClient&&) noexcept;
  ~StateClient();  ///< stops

  /// Connects, and reconnects until stop(). A second call does nothing; there is no start after stop().
  void start();

  /// Closes at once, in every state; no event after it returns. Waits for an event that is being delivered on
  /// another thread, so do not hold a lock that an event's handler takes. May be called from a handler, and
  /// twice.
  void stop();

  /// The latest health with its counters. Never blocks on a handler.
  RobotLinkHealth health() const;

 private:
  explicit StateClient(std::shared_ptr<LinkShell> shell);
  std::shared_ptr<LinkShell> shell_;
};

}  // namespace calibrd
