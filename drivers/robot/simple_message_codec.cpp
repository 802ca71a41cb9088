// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message_codec.hpp"

#include <string>
#include <utility>

#include "drivers/robot/robot_link_error.hpp"
#include "drivers/robot/simple_message/error.hpp"

namespace calibrd {
namespace sm = simple_message;
namespace {

std::optional<bool> tri_state(std::int32_t value) {
  if (value == 0) return false;
  if (value == 1) return true;
  return std::nullopt;
}

ControllerStatus::Mode mode_from(std::int32_t value) {
  if (value == 1) return ControllerStatus::Mode::manual;
  if (value == 2) return ControllerStatus::Mode::automatic;
  return ControllerStatus::Mode::unknown;
}

}  // namespace

std::vector<std::byte> SimpleMessageCodec::begin() {
  framer_.reset();
  best_kind_ = Kind::none;
  own_group_seen_ = false;
  return {};
}

CodecOutput SimpleMessageCodec::decode(std::span<const std::byte> bytes, Clock::time_point received) {
  CodecOutput output;
  while (!bytes.empty() && !output.broken) {
    if (!framer_.inside_frame()) frame_begun_ = received;
    const auto taken = framer_.take(bytes);
    if (!taken) {
      output.broken = taken.error();
      break;
    }
    if (taken->frame) take_frame(*taken->frame, output);
    bytes = bytes.subspan(taken->consumed);
  }
  return output;
}

void SimpleMessageCodec::take_frame(std::span<const std::byte> frame, CodecOutput& output) {
  const auto message = sm::decode(frame, settings_.format, settings_.limits);
  if (!message && sm::breaks_stream(message.error().code)) {
    output.broken = message.error();
    return;
  }
  ++output.messages;
  if (message) return take(*message, output);
  ++output.rejected_values;
  output.joints_problem = message.error();
}

void SimpleMessageCodec::take(const sm::Message& message, CodecOutput& output) {
  if (message.comm_type != sm::CommType::topic) {
    ++output.skipped;
    return;
  }
  if (const auto* feedback = std::get_if<sm::JointFeedback>(&message.body)) {
    take_joints(*feedback, Kind::feedback, output);
  } else if (const auto* groups = std::get_if<sm::JointFeedbackEx>(&message.body)) {
    for (int i = 0; i < groups->group_count; ++i) {
      take_joints(groups->records[static_cast<std::size_t>(i)], Kind::feedback_ex, output);
    }
  } else if (const auto* position = std::get_if<sm::JointPosition>(&message.body)) {
    take_joints({0, sm::kValidPositions, 0, position->positions, {}, {}}, Kind::position, output);
  } else if (const auto* status = std::get_if<sm::RobotStatus>(&message.body)) {
    output.status = status_from(*status);
  } else {
    ++output.skipped;
  }
}

void SimpleMessageCodec::take_joints(const sm::JointFeedback& feedback, Kind kind, CodecOutput& output) {
  if (feedback.robot_id != settings_.group) {
    ++output.other_group;
    if (own_group_seen_) return;
    output.joints_problem = Error{RobotLinkError::only_other_groups,
                                  "the controller sends group " + std::to_string(feedback.robot_id) +
                                      ", group " + std::to_string(settings_.group) + " is configured"};
    return;
  }
  own_group_seen_ = true;
  if (!(feedback.valid_fields & sm::kValidPositions)) {
    output.joints_problem = Error{RobotLinkError::no_positions, {}};
    return;
  }
  if (kind < best_kind_) return;
  if (auto outside = outside_ranges(feedback.positions, settings_.joint_ranges)) {
    ++output.rejected_values;
    output.joints_problem = std::move(outside);
    return;
  }
  best_kind_ = kind;
  ++output.joint_messages;
  ControllerJoints joints;
  joints.group = settings_.group;
  joints.stamp = frame_begun_;
  const auto count = static_cast<std::ptrdiff_t>(settings_.joint_count);
  joints.positions_rad.assign(feedback.positions.begin(), feedback.positions.begin() + count);
  if (feedback.valid_fields & sm::kValidVelocities) {
    joints.velocities_rad.assign(feedback.velocities.begin(), feedback.velocities.begin() + count);
  }
  output.joints = std::move(joints);
}

ControllerStatus SimpleMessageCodec::status_from(const sm::RobotStatus& status) const {
  ControllerStatus result;
  result.drives_powered = tri_state(status.drives_powered);
  result.e_stopped = tri_state(status.e_stopped);
  result.in_error = tri_state(status.in_error);
  result.in_motion = tri_state(status.in_motion);
  result.motion_possible = tri_state(status.motion_possible);
  result.mode = mode_from(status.mode);
  result.error_code = status.error_code;
  result.stamp = frame_begun_;
  return result;
}

}  // namespace calibrd
