// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "drivers/sim/controller/messages.hpp"

namespace calibrd::sim {

/// MOTION_CTRL (2001) or JOINT_TRAJ_PT_FULL (14), as a client sends it.
struct MotionRequest {
  static constexpr std::int32_t kPoint = 14, kControl = 2001;
  std::int32_t type = 0, group = 0, sequence = 0;
  std::int32_t command = 0;       ///< of kControl
  std::int32_t valid_fields = 0;  ///< of kPoint, as the rest
  double time_s = 0;
  TenJoints positions{}, velocities{};
};

/// MOTION_REPLY (2002).
struct MotionReplyRecord {
  std::int32_t group = 0, sequence = 0, command = 0, result = 0, subcode = 0;
};

/// Cuts the first whole message off `bytes`, which come in pieces of any size; nothing while it is not whole.
/// Throws std::runtime_error on a length that no message has.
std::optional<Bytes> cut_message(ByteOrder order, Bytes& bytes);

/// Nothing when the message is not one of the two, or not of its size.
std::optional<MotionRequest> read_motion_request(ByteOrder order, std::span<const std::uint8_t> message);

/// A service reply whose reply code says success, whatever the result.
Bytes motion_reply_message(ByteOrder order, const MotionReplyRecord& reply);

}  // namespace calibrd::sim
