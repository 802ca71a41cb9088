// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/joint_source.hpp"
#include "drivers/robot/link_machine.hpp"
#include "drivers/robot/simple_message_codec.hpp"

namespace calibrd {

class LinkShell;

/// The [robot] section of the configuration, as docs/controllers.md explains it.
struct StateClientSettings {
  std::string host;  ///< address or name
  int port = 50241;  ///< the state port; ports that command a robot are refused
  simple_message::ByteOrder byte_order = simple_message::ByteOrder::big;
  int real_bytes = 4;                    ///< 4 or 8
  int group = 0;                         ///< from 0
  int joint_count = 10;                  ///< axes of the group; the protocol always carries ten
  double max_position = 100;             ///< rad or m: beyond it a value is damage
  double max_velocity = 100;             ///< per second
  std::vector<JointRange> joint_ranges;  ///< optional, per joint in wire order
  LinkSettings link;
};

/// Every key is usable. Errors: RobotLinkError, detail names the key.
Status check(const StateClientSettings& settings);

/// Reads joints and status of one controller over the simple_message protocol and keeps the link up: one
/// connection at a time, to the state port only, nothing is ever sent. Linux. Thread-safe. stop() or destroy
/// it before the executor's context ends.
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
