// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <variant>
#include <vector>

#include "drivers/robot/joint_source.hpp"
#include "drivers/robot/state_codec.hpp"

namespace calibrd {

/// When a link is stale, silent, and how patiently it comes back.
struct LinkSettings {
  using Interval = std::chrono::milliseconds;

  Interval stale_after{250};       ///< a kind of message is stale when none came for so long
  Interval reconnect_after{2000};  ///< without any message; what lasted so long counts as settled
  Interval connect_timeout{900};   ///< name look-up included; a peer that comes back is found within a second
  Interval backoff_first{50};      ///< pause before a new attempt; doubles until a connection has settled
  Interval backoff_cap{500};
  /// A controller that closes a connection so soon after accepting it has given its slot to another client.
  /// The reference client comes back after 5 s, so anything below that would miss the fight.
  Interval eviction_within{10000};
  Interval eviction_pause{30000};  ///< after two such closes in a row
};

/// What the shell must do next, in this order.
namespace link_step {
/// Open a connection; answer with on_connected or on_connect_failed.
struct Connect {};
/// Close the connection or give up the attempt; no answer expected.
struct Close {};
struct Send {
  std::vector<std::byte> bytes;
};
/// Call on_tick then; replaces an earlier one.
struct ArmTimer {
  Clock::time_point at;
};
struct DeliverJoints {
  ControllerJoints joints;
};
struct DeliverStatus {
  ControllerStatus status;
};
struct ReportHealth {
  RobotLinkHealth health;
};
}  // namespace link_step

using LinkStep = std::variant<link_step::Connect, link_step::Close, link_step::Send, link_step::ArmTimer,
                              link_step::DeliverJoints, link_step::DeliverStatus, link_step::ReportHealth>;
using LinkSteps = std::vector<LinkStep>;

/// Bytes as the shell read them.
struct Received {
  std::span<const std::byte> bytes;
  Clock::time_point stamp;    ///< when they arrived; never after `now`
  bool more_waiting = false;  ///< more bytes had already arrived: joints are held back until the last of them
};

/// Decides everything about one link to one controller, without I/O: when to connect, what to deliver, what
/// is stale, when to give up and how long to wait. Events go in, steps come out. One codec, one connection at
/// a time. Not thread-safe. Times given must not run backwards.
class LinkMachine {
 public:
  LinkMachine(std::unique_ptr<StateCodec> codec, LinkSettings settings)
      : codec_(std::move(codec)), settings_(settings), backoff_(settings.backoff_first) {}

  LinkSteps start(Clock::time_point now);
  LinkSteps on_connected(Clock::time_point now);
  LinkSteps on_connect_failed(const std::error_code& why, Clock::time_point now);
  LinkSteps on_received(const Received& received, Clock::time_point now);
  /// The peer closed (no error) or the connection broke.
  LinkSteps on_closed(const std::error_code& why, Clock::time_point now);
  LinkSteps on_tick(Clock::time_point now);
  /// An event or a step of it has failed half-way, for want of memory say: whatever it has left undone, the
  /// connection starts anew. `what`: the cause in words.
  LinkSteps on_trouble(const std::string& what, Clock::time_point now);
  /// For good: every later event is ignored, nothing more is reported.
  LinkSteps stop();

  const RobotLinkHealth& health() const { return health_; }

 private:
  enum class Phase { idle, waiting, connecting, connected, stopped };
  using State = RobotLinkHealth::State;

  void connect(Clock::time_point now);
  void lose(State state, const Error& why, Clock::time_point now);
  void account(const CodecOutput& output);
  void take(CodecOutput& output, Clock::time_point now);
  void deliver_joints();
  bool fresh(const std::optional<Clock::time_point>& stamp, Clock::time_point now) const;
  void judge_connection(Clock::time_point now);
  Clock::time_point next_deadline(Clock::time_point now) const;
  LinkSteps finish(Clock::time_point now);

  std::unique_ptr<StateCodec> codec_;
  LinkSettings settings_;
  Phase phase_ = Phase::idle;
  LinkSteps steps_;
  std::optional<Clock::time_point> armed_;

  Clock::time_point wake_at_{};  // end of the pause, or of the patience with a connection attempt
  Clock::time_point connected_at_{};
  Clock::time_point alive_at_{};  // last message of any kind, or the connection's start
  Clock::time_point awake_at_{};  // last event: when this process last looked
  std::chrono::milliseconds backoff_;
  int quick_closes_ = 0;

  std::optional<ControllerJoints> held_joints_;
  std::optional<Clock::time_point> joints_stamp_, status_stamp_;
  std::optional<Error> joints_problem_;
  std::uint64_t sequence_ = 0;
  RobotLinkHealth health_, reported_;
};

}  // namespace calibrd
