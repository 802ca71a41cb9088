// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/motion/joint_move.hpp"
#include "drivers/robot/simple_message/framer.hpp"
#include "drivers/robot/simple_message/message.hpp"

namespace calibrd {

/// What MOTION_CTRL (2001) asks of MotoROS. Those that switch servos or reset alarms are left out on purpose.
enum class MotionCommand : std::int32_t {
  check_motion_ready = 200101,
  stop_motion = 200111,
  start_trajectory_mode = 200121,
  stop_trajectory_mode = 200122,
  disconnect = 200130,
};

/// The result of MOTION_REPLY (2002); anything else is read as invalid.
enum class MotionResult : std::int32_t {
  success,
  busy,
  failure,
  invalid,
  alarm,
  not_ready,
  controller_failure
};

/// One answer; its header's reply code says success always, so only `result` counts.
struct MotionAnswer {
  std::int32_t command = 0;  ///< a MotionCommand, or JointTrajectoryPointFull::kType
  std::int32_t sequence = 0;
  MotionResult result = MotionResult::invalid;
  std::int32_t subcode = 0;
};

/// "not ready: emergency stop (5003)"
std::string in_words(const MotionAnswer& answer);
/// "check motion ready (200101)"
std::string in_words(MotionCommand command);

/// The motion port's messages as bytes. No I/O. Each request is one message, to be sent in one piece:
/// MotoROS misreads a request that comes in two.
class MotionCodec {
 public:
  MotionCodec(simple_message::WireFormat format, int group)
      : format_(format), group_(group), framer_(format.byte_order) {}

  std::vector<std::byte> control(MotionCommand command, std::int32_t sequence) const;
  /// At most ten joints; the first point of a move has sequence 0.
  std::vector<std::byte> point(std::int32_t sequence, const TrajectoryPoint& point) const;

  /// Answers in the next bytes of the connection, in pieces of any size.
  /// Errors: SimpleMessageError; MotionError::reply_unreadable for another message or another group.
  Result<std::vector<MotionAnswer>> decode(std::span<const std::byte> bytes);

 private:
  std::vector<std::byte> request(simple_message::Body body) const;
  Result<MotionAnswer> read(std::span<const std::byte> frame) const;

  simple_message::WireFormat format_;
  std::int32_t group_;
  simple_message::Framer framer_;
};

}  // namespace calibrd
