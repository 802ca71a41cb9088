// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_codec.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/simple_message/decode.hpp"
#include "drivers/robot/simple_message/encode.hpp"

namespace calibrd {
namespace sm = simple_message;
namespace {

constexpr std::pair<std::int32_t, std::string_view> kSubcodes[] = {
    {3000, "unspecified"},
    {3001, "message size"},
    {3002, "header"},
    {3003, "message type"},
    {3004, "group number"},
    {3005, "sequence"},
    {3006, "command"},
    {3010, "data"},
    {3011, "the first point is not where the robot is"},
    {3012, "position"},
    {3013, "speed"},
    {3014, "acceleration"},
    {3015, "data missing"},
    {3016, "time"},
    {3017, "tool number"},
    {5000, "unspecified"},
    {5001, "alarm"},
    {5002, "error"},
    {5003, "emergency stop"},
    {5004, "not in PLAY"},
    {5005, "not in REMOTE"},
    {5006, "servos off"},
    {5007, "hold"},
    {5008, "the ROS job is not started"},
    {5009, "the ROS job does not wait for motion"},
    {5010, "skillsend"},
    {5011, "power and force limiting is active"},
    {5012, "an incremental move failed"},
};

constexpr const char* kResults[] = {
    "success", "busy", "failure", "invalid", "alarm", "not ready", "failure of the controller"};

sm::JointValues ten(const std::vector<double>& values) {
  if (values.size() > sm::kJointCount) throw std::invalid_argument("a message carries ten joints");
  sm::JointValues all{};
  std::copy(values.begin(), values.end(), all.begin());
  return all;
}

MotionResult result_of(std::int32_t value) {
  const bool known = value >= 0 && value <= static_cast<std::int32_t>(MotionResult::controller_failure);
  return known ? static_cast<MotionResult>(value) : MotionResult::invalid;
}

}  // namespace

std::string in_words(const MotionAnswer& answer) {
  std::string text = kResults[static_cast<std::size_t>(answer.result)];
  if (answer.subcode == 0) return text;
  const auto* known =
      std::ranges::find(kSubcodes, answer.subcode, &std::pair<std::int32_t, std::string_view>::first);
  if (known != std::end(kSubcodes)) text.append(": ").append(known->second);
  return text + " (" + std::to_string(answer.subcode) + ")";
}

std::string in_words(MotionCommand command) {
  const auto name = [&] {
    switch (command) {
      case MotionCommand::check_motion_ready:
        return "check motion ready";
      case MotionCommand::stop_motion:
        return "stop motion";
      case MotionCommand::start_trajectory_mode:
        return "start trajectory mode";
      case MotionCommand::stop_trajectory_mode:
        return "stop trajectory mode";
      case MotionCommand::disconnect:
        return "disconnect";
    }
    return "command";
  }();
  return std::string(name) + " (" + std::to_string(static_cast<std::int32_t>(command)) + ")";
}

std::vector<std::byte> MotionCodec::request(sm::Body body) const {
  return sm::encode({sm::CommType::service_request, sm::ReplyCode::none, std::move(body)}, format_);
}

std::vector<std::byte> MotionCodec::control(MotionCommand command, std::int32_t sequence) const {
  return request(sm::MotionControl{group_, sequence, static_cast<std::int32_t>(command), {}});
}

std::vector<std::byte> MotionCodec::point(std::int32_t sequence, const TrajectoryPoint& point) const {
  return request(sm::JointTrajectoryPointFull{group_, sequence, sm::kValidMask, point.time_s,
                                              ten(point.positions_rad), ten(point.velocities_rad_s),
                                              ten(point.accelerations_rad_s2)});
}

Result<MotionAnswer> MotionCodec::read(std::span<const std::byte> frame) const {
  const auto message = sm::decode(frame, format_);
  if (!message) return message.error();
  const auto* reply = std::get_if<sm::MotionReply>(&message->body);
  if (!reply || message->comm_type != sm::CommType::service_reply || reply->group != group_)
    return Error{MotionError::reply_unreadable, {}};
  return MotionAnswer{reply->command, reply->sequence, result_of(reply->result), reply->subcode};
}

Result<std::vector<MotionAnswer>> MotionCodec::decode(std::span<const std::byte> bytes) {
  std::vector<MotionAnswer> answers;
  while (!bytes.empty()) {
    const auto taken = framer_.take(bytes);
    if (!taken) return taken.error();
    if (taken->frame) {
      const auto answer = read(*taken->frame);
      if (!answer) return answer.error();
      answers.push_back(*answer);
    }
    bytes = bytes.subspan(taken->consumed);
  }
  return answers;
}

}  // namespace calibrd
