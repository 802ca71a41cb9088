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

FeedbackRecord group_record(const WorldState& world, const ControllerSettings& settings, const Joints& robot,
                            std::int32_t group, std::int64_t now_ns) {
  FeedbackRecord record;
  record.group = group;
  record.valid_fields = kPositionValid | (settings.send_velocity != 0 ? kVelocityValid : 0);
  if (group == 0) record.positions = ten(robot);
  if (group == 1) record.positions = ten(world.other_robot.joints);
  if (group == 0 && settings.send_velocity != 0 && settings.mode != ControllerSettings::Mode::frozen)
    record.velocities = ten(world.motion.velocities_at(sampled_ns(settings, now_ns)));
  return record;
}

bool is_moving(const WorldState& world, std::int64_t now_ns) {
  const Joints v = world.motion.velocities_at(now_ns);
  return std::any_of(v.begin(), v.end(), [](double speed) { return std::abs(speed) > kMoving_rad_s; });
}

StatusRecord status_record(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns) {
  StatusRecord status;
  status.drives_powered = settings.drives_powered;
  status.e_stopped = settings.e_stopped;
  status.in_error = settings.in_error;
  status.error_code = settings.in_error != 0 ? kSomeAlarm : 0;
  status.in_motion = is_moving(world, now_ns) || world.motion.commanded.end_ns() > now_ns ? 1 : 0;
  status.mode = settings.automatic != 0 ? kPlay : kTeach;
  status.motion_possible = not_ready_subcode(world, settings, now_ns) == 0 ? 1 : 0;
  return status;
}

}  // namespace

Joints reported_joints(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns) {
  return world.reported_at(sampled_ns(settings, now_ns));
}

std::vector<Bytes> controller_cycle(const WorldState& world, const ControllerSettings& settings,
                                    const Joints& frozen, std::int64_t now_ns) {
  using Mode = ControllerSettings::Mode;
  if (settings.mode == Mode::silent || settings.mode == Mode::refuse) return {};
  const ByteOrder order = settings.big_endian != 0 ? ByteOrder::big : ByteOrder::little;
  const Joints robot = settings.mode == Mode::frozen ? frozen : reported_joints(world, settings, now_ns);
  std::vector<Bytes> sends;
  if (settings.mode != Mode::status_only && settings.protocol == ControllerSettings::Protocol::joint_position)
    sends.push_back(joint_position_message(order, 0, ten(robot)));
  if (settings.mode != Mode::status_only && settings.protocol == ControllerSettings::Protocol::motoros) {
    std::vector<FeedbackRecord> records;
    for (std::int32_t g = 0; g < settings.groups; ++g)
      records.push_back(group_record(world, settings, robot, g, now_ns));
    for (const auto& record : records) sends.push_back(joint_feedback_message(order, record));
    if (records.size() > 1) sends.push_back(joint_feedback_ex_message(order, records));
  }
  sends.push_back(status_message(order, status_record(world, settings, now_ns)));
  return sends;
}

}  // namespace calibrd::sim
