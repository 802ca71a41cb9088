// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "drivers/robot/joint_limits.hpp"
#include "drivers/robot/simple_message/decode.hpp"
#include "drivers/robot/simple_message/framer.hpp"
#include "drivers/robot/state_codec.hpp"

namespace calibrd {

struct SimpleMessageSettings {
  simple_message::WireFormat format;
  simple_message::ValueLimits limits;
  int group = 0;                                          ///< the robot's group, from 0
  std::size_t joint_count = simple_message::kJointCount;  ///< how many of the ten joints are delivered
  std::vector<JointRange> joint_ranges;  ///< per joint in wire order; may be shorter than joint_count
};

/// Joints and status from a simple_message state stream (MotoROS port 50241, others 11002). The peer talks
/// first and is never answered.
class SimpleMessageCodec : public StateCodec {
 public:
  explicit SimpleMessageCodec(SimpleMessageSettings settings)
      : settings_(std::move(settings)), framer_(settings_.format.byte_order) {}

  std::vector<std::byte> begin() override;
  CodecOutput decode(std::span<const std::byte> bytes, Clock::time_point received) override;

 private:
  // A controller may send the same joints in several messages of one cycle; the best kind seen wins.
  enum class Kind { none, position, feedback_ex, feedback };

  void take_frame(std::span<const std::byte> frame, CodecOutput& output);
  void take(const simple_message::Message& message, CodecOutput& output);
  void take_joints(const simple_message::JointFeedback& feedback, Kind kind, CodecOutput& output);
  ControllerStatus status_from(const simple_message::RobotStatus& status) const;

  SimpleMessageSettings settings_;
  simple_message::Framer framer_;
  Clock::time_point frame_begun_{};
  Kind best_kind_ = Kind::none;
  bool own_group_seen_ = false;
};

}  // namespace calibrd
