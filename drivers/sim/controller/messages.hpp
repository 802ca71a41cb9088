// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calibrd::sim {

using Bytes = std::vector<std::uint8_t>;

/// simple_message carries ten joints always; unused ones are 0.
using TenJoints = std::array<double, 10>;

enum class ByteOrder { little, big };

/// One group's record in JOINT_FEEDBACK and JOINT_FEEDBACK_EX. rad, rad/s, rad/s^2.
struct FeedbackRecord {
  std::int32_t group = 0;
  std::int32_t valid_fields = 0;  ///< bits: 1 time, 2 position, 4 velocity, 8 acceleration
  double time_s = 0;
  TenJoints positions{}, velocities{}, accelerations{};
};

/// Tri-states: -1 unknown, 0 no, 1 yes. mode: -1 unknown, 1 teach, 2 play.
struct StatusRecord {
  std::int32_t drives_powered = 1, e_stopped = 0, error_code = 0, in_error = 0, in_motion = 0, mode = 2,
               motion_possible = 1;
};

// Whole messages of simple_message (topics), length field first. The simulator's own encoder: it shares
// nothing with the client's codec, both are checked against the same recorded bytes.
Bytes joint_position_message(ByteOrder order, std::int32_t sequence, const TenJoints& joints_rad);
Bytes joint_feedback_message(ByteOrder order, const FeedbackRecord& record);
/// Always four records on the wire; at most four may be given.
Bytes joint_feedback_ex_message(ByteOrder order, std::span<const FeedbackRecord> records);
Bytes status_message(ByteOrder order, const StatusRecord& status);

}  // namespace calibrd::sim
