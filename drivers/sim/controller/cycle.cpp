// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/cycle.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/sim/controller/motion_commands.hpp"

namespace calibrd::sim {
namespace {

constexpr std::int32_t kPositionValid = 2, kVelocityValid = 4;
constexpr double kMoving_rad_s = 1e-4;
constexpr std::int32_t kTeach = 1, kPlay = 2, kSomeAlarm = 4107;

std::int64_t sampled_ns(const ControllerSettings& settings, std::int64_t now_ns) {
  return now_ns - std::llround(settings.latency_s * 1e9);
}

TenJoints ten(const Joints& joints) {
  TenJoints wire{};
  std::copy_n(joints.begin(), wire.size(), wire.begin());
  return wire;
}

/// FANUC states J3 against the horizontal, not against the upper arm.
Joints in_terms_of(const ControllerSettings& settings, Joints model) {
  if (settings.j3_from_horizontal != 0) model[2] -= model[1];
  return model;
}

Joints reported_velocities(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns) {
  if (settings.mode == ControllerSettings::Mode::frozen) return {};
  return in_terms_of(settings, world.motion.velocities_at(sampled_ns(settings, now_ns)));
}

FeedbackRecord group_record(const WorldState& world, const ControllerSettings& settings, const Joints& robot,
                            std::int32_t group, std::int64_t now_ns) {
  FeedbackRecord record;
  record.group = group;
  record.valid_fields = kPositionValid | (settings.send_velocity != 0 ? kVelocityValid : 0);
  if (group == 0) record.positions = ten(robot);
  if (group == 1) record.positions = ten(world.other_robot.joints);
  if (group == 0 && settings.send_velocity != 0)
    record.velocities = ten(reported_velocities(world, settings, now_ns));
  return record;
}

bool is_moving(const WorldState& world, std::int64_t now_ns) {
  const Joints v = world.motion.velocities_at(now_ns);
  return std::any_of(v.begin(), v.end(), [](double speed) { return std::abs(speed) > kMoving_rad_s; });
}

std::vector<Bytes> joint_messages(const WorldState& world, const ControllerSettings& settings,
                                  const Joints& robot, std::int64_t now_ns) {
  const ByteOrder order = settings.big_endian != 0 ? ByteOrder::big : ByteOrder::little;
  if (settings.protocol == ControllerSettings::Protocol::joint_position)
    return {joint_position_message(order, 0, ten(robot))};
  std::vector<FeedbackRecord> records(static_cast<std::size_t>(settings.groups));
  std::vector<Bytes> messages(records.size());
  for (std::size_t g = 0; g < records.size(); ++g) {
    records[g] = group_record(world, settings, robot, static_cast<std::int32_t>(g), now_ns);
    messages[g] = joint_feedback_message(order, records[g]);
  }
  if (records.size() > 1) messages.push_back(joint_feedback_ex_message(order, records));
  return messages;
}

StatusRecord status_record(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns) {
  StatusRecord status;
  status.drives_powered = settings.e_stopped != 0 ? 0 : settings.drives_powered;
  status.e_stopped = settings.e_stopped;
  status.in_error = settings.in_error;
  status.error_code = settings.in_error != 0 ? kSomeAlarm : 0;
  status.in_motion = is_moving(world, now_ns) || world.motion.commanded.end_ns() > now_ns ? 1 : 0;
  status.mode = settings.automatic != 0 ? kPlay : kTeach;
  status.motion_possible = not_ready_subcode(world, settings, now_ns) == 0 ? 1 : 0;
  return status;
}

std::vector<Bytes> in_pieces(const std::vector<Bytes>& messages, std::size_t size) {
  std::vector<Bytes> pieces;
  for (const Bytes& message : messages)
    for (std::size_t at = 0; at < message.size(); at += size)
      pieces.emplace_back(message.begin() + static_cast<std::ptrdiff_t>(at),
                          message.begin() + static_cast<std::ptrdiff_t>(std::min(at + size, message.size())));
  return pieces;
}

}  // namespace

Joints reported_joints(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns) {
  return in_terms_of(settings, world.reported_at(sampled_ns(settings, now_ns)));
}

std::vector<Bytes> controller_cycle(const WorldState& world, const ControllerSettings& settings,
                                    const Frozen& frozen, std::int64_t now_ns, std::uint64_t cycle) {
  using Mode = ControllerSettings::Mode;
  if (settings.mode == Mode::silent || settings.mode == Mode::refuse) return {};
  std::vector<Bytes> sends;
  if (settings.mode != Mode::status_only) {
    const bool still = settings.mode == Mode::frozen;
    sends = joint_messages(world, settings, still ? frozen.joints : reported_joints(world, settings, now_ns),
                           now_ns);
  }
  const ByteOrder order = settings.big_endian != 0 ? ByteOrder::big : ByteOrder::little;
  if (cycle % static_cast<std::uint64_t>(settings.status_every) == 0)
    sends.push_back(status_message(order, status_record(world, settings, now_ns)));
  return settings.send_bytes > 0 ? in_pieces(sends, static_cast<std::size_t>(settings.send_bytes)) : sends;
}

RtdeState rtde_state(const WorldState& world, const ControllerSettings& settings, const Frozen& frozen,
                     std::int64_t now_ns, std::int64_t started_ns) {
  using Mode = ControllerSettings::Mode;
  const bool is_frozen = settings.mode == Mode::frozen;
  RtdeState state;
  state.timestamp_s =
      static_cast<double>(sampled_ns(settings, is_frozen ? frozen.at_ns : now_ns) - started_ns) * 1e-9;
  const Joints joints = is_frozen ? frozen.joints : reported_joints(world, settings, now_ns);
  const Joints speeds = reported_velocities(world, settings, now_ns);
  std::copy_n(joints.begin(), state.positions_rad.size(), state.positions_rad.begin());
  std::copy_n(speeds.begin(), state.velocities_rad_s.size(), state.velocities_rad_s.begin());
  state.emergency_stop = settings.e_stopped != 0;
  state.arm_has_power = settings.mode != Mode::status_only && !state.emergency_stop;
  return state;
}

}  // namespace calibrd::sim
