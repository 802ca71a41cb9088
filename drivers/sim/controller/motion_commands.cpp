// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/motion_commands.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::sim {
namespace {

constexpr std::int32_t kCheckReady = 200101, kCheckQueue = 200102, kStop = 200111, kStartMode = 200121,
                       kStopMode = 200122, kDisconnect = 200130;
constexpr std::int32_t kSuccess = 0, kBusy = 1, kFailure = 2, kInvalid = 3, kNotReady = 5;
constexpr std::int32_t kWrongGroup = 3004, kWrongSequence = 3005, kWrongCommand = 3006, kWrongStart = 3011,
                       kTooFast = 3013, kDataMissing = 3015;
constexpr std::int32_t kAlarm = 5001, kEmergencyStop = 5003, kNotPlay = 5004, kServoOff = 5006,
                       kNotStarted = 5008, kNotWaiting = 5009;
constexpr std::int32_t kTimePositionVelocity = 7;
constexpr double kStartTolerance_rad = 5e-4;  // 30 pulses of about 1000 per degree
constexpr double kFastest_rad_s = 3.5;
constexpr std::int64_t kQueue_ns = 800'000'000;  // 200 increments of 4 ms

struct Outcome {
  std::int32_t result, subcode;
};

Joints true_joints(const TenJoints& wire, const WorldState& world) {
  Joints joints{};
  for (std::size_t j = 0; j < static_cast<std::size_t>(world.joint_count) && j < wire.size(); ++j)
    joints[j] = wire[j] + world.joint_zero_rad[j];
  return joints;
}

Joints speeds(const TenJoints& wire) {
  Joints joints{};
  std::copy(wire.begin(), wire.end(), joints.begin());
  return joints;
}

double widest(const Joints& a, const Joints& b) {
  double widest = 0;
  for (std::size_t j = 0; j < a.size(); ++j) widest = std::max(widest, std::abs(a[j] - b[j]));
  return widest;
}

Outcome begin(const MotionRequest& request, WorldState& world, std::int64_t now_ns) {
  const Joints here = world.motion.positions_at(now_ns);
  if (has_queue(world, now_ns) || widest(true_joints(request.positions, world), here) > kStartTolerance_rad)
    return {kInvalid, kWrongStart};
  world.motion.take_commands(now_ns);
  return {kSuccess, 0};
}

Outcome add(const MotionRequest& request, double after_s, WorldState& world, std::int64_t now_ns) {
  auto& commanded = world.motion.commanded;
  if (commanded.count == 0 || after_s <= 0) return {kInvalid, kWrongSequence};
  if (commanded.end_ns() - now_ns > kQueue_ns) return {kBusy, 0};
  if (widest(speeds(request.velocities), {}) > kFastest_rad_s) return {kInvalid, kTooFast};
  commanded.add(after_s, true_joints(request.positions, world), speeds(request.velocities), now_ns);
  return {kSuccess, 0};
}

Outcome take_point(const MotionRequest& request, double& last_point_s, WorldState& world,
                   const ControllerSettings& settings, std::int64_t now_ns) {
  if (const auto subcode = not_ready_subcode(world, settings, now_ns)) return {kNotReady, subcode};
  if (request.group != 0) return {kInvalid, kWrongGroup};
  if (request.sequence < 0) return {kInvalid, kWrongSequence};
  if ((request.valid_fields & kTimePositionVelocity) != kTimePositionVelocity)
    return {kInvalid, kDataMissing};
  const Outcome outcome = request.sequence == 0 ? begin(request, world, now_ns)
                                                : add(request, request.time_s - last_point_s, world, now_ns);
  if (outcome.result == kSuccess) last_point_s = request.time_s;
  return outcome;
}

Outcome control(const MotionRequest& request, WorldState& world, ControllerSettings& settings,
                std::int64_t now_ns) {
  const auto subcode = not_ready_subcode(world, settings, now_ns);
  switch (request.command) {
    case kCheckReady:
      return {subcode == 0 ? kSuccess : kFailure, subcode};
    case kCheckQueue:
      return {kSuccess, has_queue(world, now_ns) ? 1 : 0};
    case kStop:
      world.motion.commanded.stop(now_ns);
      return {kSuccess, 0};
    case kStartMode:
      if (subcode == kNotStarted) settings.motion_possible = 1;
      return subcode == 0 || subcode == kNotStarted ? Outcome{kSuccess, 0} : Outcome{kNotReady, subcode};
    case kStopMode:
    case kDisconnect:
      if (has_queue(world, now_ns)) return {kFailure, 0};
      settings.motion_possible = 0;
      return {kSuccess, 0};
    default:
      return {kInvalid, kWrongCommand};
  }
}

}  // namespace

bool has_queue(const WorldState& world, std::int64_t now_ns) {
  return world.motion.commanded.count > 0 && world.motion.commanded.end_ns() > now_ns;
}

std::int32_t not_ready_subcode(const WorldState& world, const ControllerSettings& settings,
                               std::int64_t now_ns) {
  if (settings.in_error != 0) return kAlarm;
  if (settings.e_stopped != 0) return kEmergencyStop;
  if (settings.automatic == 0) return kNotPlay;
  if (settings.drives_powered == 0) return kServoOff;
  if (world.motion.is_running(now_ns)) return kNotWaiting;
  return settings.motion_possible == 0 ? kNotStarted : 0;
}

MotionCommands::Answer MotionCommands::obey(const MotionRequest& request, WorldState& world,
                                            ControllerSettings& settings, std::int64_t now_ns) {
  const bool is_point = request.type == MotionRequest::kPoint;
  const std::int32_t command = is_point ? request.type : request.command;
  ++counts_[command];
  const Outcome outcome = is_point ? take_point(request, last_point_s_, world, settings, now_ns)
                                   : control(request, world, settings, now_ns);
  return {{request.group, request.sequence, command, outcome.result, outcome.subcode},
          command == kDisconnect && outcome.result == kSuccess};
}

}  // namespace calibrd::sim
