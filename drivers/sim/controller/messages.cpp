// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/messages.hpp"

#include <bit>

#include "drivers/sim/controller/motion_messages.hpp"

namespace calibrd::sim {
namespace {

constexpr std::int32_t kJointPosition = 10, kStatus = 13, kJointFeedback = 15, kJointFeedbackEx = 2017,
                       kMotionReply = 2002;
constexpr std::int32_t kTopic = 1, kServiceReply = 3, kNotAReply = 0, kReplySuccess = 1;
constexpr std::size_t kExRecords = 4;

class Message {
 public:
  Message(ByteOrder order, std::int32_t type, std::int32_t comm_type = kTopic,
          std::int32_t reply_code = kNotAReply)
      : order_(order) {
    for (std::int32_t field : {0, type, comm_type, reply_code}) integer(field);
  }

  void integer(std::int32_t value) { word(static_cast<std::uint32_t>(value)); }
  void real(double value) { word(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void reals(const TenJoints& values) {
    for (double value : values) real(value);
  }

  /// The bytes, with the length (of all that follows the length field) filled in.
  Bytes finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size() - 4);
    for (std::size_t i = 0; i < 4; ++i) bytes_[i] = byte_of(length, i);
    return std::move(bytes_);
  }

 private:
  std::uint8_t byte_of(std::uint32_t value, std::size_t index) const {
    const std::size_t shift = order_ == ByteOrder::big ? 3 - index : index;
    return static_cast<std::uint8_t>(value >> (8 * shift));
  }
  void word(std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes_.push_back(byte_of(value, i));
  }

  ByteOrder order_;
  Bytes bytes_;
};

void add(Message& message, const FeedbackRecord& record) {
  message.integer(record.group);
  message.integer(record.valid_fields);
  message.real(record.time_s);
  message.reals(record.positions);
  message.reals(record.velocities);
  message.reals(record.accelerations);
}

}  // namespace

Bytes joint_position_message(ByteOrder order, std::int32_t sequence, const TenJoints& joints_rad) {
  Message message(order, kJointPosition);
  message.integer(sequence);
  message.reals(joints_rad);
  return message.finish();
}

Bytes joint_feedback_message(ByteOrder order, const FeedbackRecord& record) {
  Message message(order, kJointFeedback);
  add(message, record);
  return message.finish();
}

Bytes joint_feedback_ex_message(ByteOrder order, std::span<const FeedbackRecord> records) {
  Message message(order, kJointFeedbackEx);
  message.integer(static_cast<std::int32_t>(records.size()));
  for (std::size_t i = 0; i < kExRecords; ++i)
    add(message, i < records.size() ? records[i] : FeedbackRecord{});
  return message.finish();
}

Bytes status_message(ByteOrder order, const StatusRecord& status) {
  Message message(order, kStatus);
  for (std::int32_t field : {status.drives_powered, status.e_stopped, status.error_code, status.in_error,
                             status.in_motion, status.mode, status.motion_possible})
    message.integer(field);
  return message.finish();
}

Bytes motion_reply_message(ByteOrder order, const MotionReplyRecord& reply) {
  Message message(order, kMotionReply, kServiceReply, kReplySuccess);
  for (std::int32_t field : {reply.group, reply.sequence, reply.command, reply.result, reply.subcode})
    message.integer(field);
  message.reals({});
  return message.finish();
}

}  // namespace calibrd::sim
