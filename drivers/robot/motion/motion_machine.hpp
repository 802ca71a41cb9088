// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "drivers/robot/motion/commanded_path.hpp"
#include "drivers/robot/motion/motion_codec.hpp"
#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/motion/motion_watch.hpp"

namespace calibrd {

struct MotionSettings {
  simple_message::WireFormat format;
  int group = 0;
  JointMoveLimits limits{0.0873, 0.1745};
  PathTolerance path;
  double arrived_rad = 0.0035;                             ///< so near to a posture counts as there
  Clock::duration hold = std::chrono::seconds(2);          ///< at each posture
  Clock::duration ahead = std::chrono::milliseconds(300);  ///< how far ahead of the robot points are sent
  Clock::duration watch_period = std::chrono::milliseconds(20);
  Clock::duration held_up_after = std::chrono::milliseconds(250);  ///< without a look at the robot
  Clock::duration connect_timeout = std::chrono::seconds(2);
  Clock::duration reply_timeout = std::chrono::seconds(1);
  Clock::duration mode_timeout = std::chrono::seconds(6);         ///< MotoROS waits up to 5 s for its job
  Clock::duration stop_timeout = std::chrono::milliseconds(300);  ///< then the connection is closed instead
  Clock::duration arrive_timeout = std::chrono::seconds(3);       ///< after a move's last point
};

/// Postures to visit, in the controller's joint order and units, and where the robot was when the way there
/// was checked.
struct MotionOrder {
  std::vector<double> from_rad;
  std::vector<std::vector<double>> postures_rad;
};

/// How a motion ended.
struct MotionEnd {
  std::optional<Error> error;  ///< nothing: every posture was visited
};

/// What the shell must do next, in this order.
namespace motion_step {
/// Open a connection; answer with on_connected or on_connect_failed.
struct Connect {};
/// Send the bytes in one piece; `what` for the log: which command, and why.
struct Send {
  std::vector<std::byte> bytes;
  std::string what;
};
/// Call on_tick then; replaces an earlier one.
struct ArmTimer {
  Clock::time_point at;
};
/// So many postures have been reached.
struct Reached {
  std::size_t postures;
};
/// Close the connection or give up the attempt; no answer expected.
struct Close {};
/// The last step of all.
struct Finish {
  MotionEnd end;
};
}  // namespace motion_step

using MotionStep = std::variant<motion_step::Connect, motion_step::Send, motion_step::ArmTimer,
                                motion_step::Reached, motion_step::Close, motion_step::Finish>;
using MotionSteps = std::vector<MotionStep>;

/// Decides everything about one motion, without I/O: when the port is opened, which command goes out when,
/// and what ends it. Any doubt of the watch, and any answer but success, ends it: stop motion, stop
/// trajectory mode, disconnect, close. A motion that ends well leaves trajectory mode as it was found. Events
/// go in, steps come out. Not thread-safe. Times given must not run backwards.
class MotionMachine {
 public:
  /// `watch` must outlive it; whoever feeds the watch calls on_watch() afterwards.
  MotionMachine(MotionOrder order, MotionSettings settings, const MotionWatch& watch);

  /// Opens nothing while there is a doubt: then the only step is Finish.
  MotionSteps start(Clock::time_point now);
  MotionSteps on_connected(Clock::time_point now);
  MotionSteps on_connect_failed(const std::error_code& why, Clock::time_point now);
  MotionSteps on_received(std::span<const std::byte> bytes, Clock::time_point now);
  /// The peer closed (no error) or the connection broke.
  MotionSteps on_closed(const std::error_code& why, Clock::time_point now);
  MotionSteps on_watch(Clock::time_point now);
  MotionSteps on_tick(Clock::time_point now);
  /// Stops at once. `why`: stop_requested or daemon_ends. A motion that is being stopped stays so.
  MotionSteps stop(MotionError why, Clock::time_point now);

 private:
  enum class Phase {
    idle,
    connecting,
    checking,       // motion ready?
    starting,       // trajectory mode
    moving,         // points go out, then the robot comes to rest
    holding,        // at a posture
    stopping,       // stop motion
    leaving,        // stop trajectory mode
    disconnecting,  // the controller closes
    ended
  };
  struct Request {
    std::int32_t command, sequence;
  };

  bool is_commanding() const { return phase_ >= Phase::checking && phase_ <= Phase::holding; }
  bool is_stopping() const { return phase_ >= Phase::stopping && phase_ <= Phase::disconnecting; }

  void send(MotionCommand command, const std::string& why, Clock::duration patience, Clock::time_point now);
  void send_point(Clock::time_point now);
  void take(const MotionAnswer& answer, Clock::time_point now);
  void obey(const MotionAnswer& answer, Clock::time_point now);
  void take_point_answer(const MotionAnswer& answer, Clock::time_point now);
  void begin_move(Clock::time_point now);
  void look(Clock::time_point now);
  std::optional<Error> find_doubt(Clock::time_point now) const;
  bool is_elsewhere() const;
  void go_on_moving(Clock::time_point now);
  bool has_arrived(Clock::time_point now) const;
  void go_on_holding(Clock::time_point now);
  void give_up(Error why, Clock::time_point now);
  void go_on_stopping(const MotionAnswer& answer, Clock::time_point now);
  void end();
  MotionSteps finish(Clock::time_point now);

  const MotionOrder order_;
  const MotionSettings settings_;
  const MotionWatch& watch_;
  MotionCodec codec_;

  Phase phase_ = Phase::idle;
  MotionSteps steps_;
  std::optional<Error> error_;
  Clock::time_point looked_at_{};  // last event: when this process last looked

  std::deque<Request> unanswered_;  // oldest first
  std::optional<Clock::time_point> answer_due_;
  std::int32_t sequence_ = 0;  // of MOTION_CTRL

  std::size_t reached_ = 0;
  std::optional<CommandedPath> path_;
  int next_point_ = 0;
  std::optional<Clock::time_point> busy_since_, retry_at_, hold_until_;
};

}  // namespace calibrd
