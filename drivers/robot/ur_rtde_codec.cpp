// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/ur_rtde_codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace calibrd {

using rtde::RobotMode;
using rtde::RtdeError;
using rtde::SafetyBit;

namespace {

/// The first value that no joint can have.
std::optional<Error> check_values(const char* what, std::span<const double> values, double limit) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) <= limit) continue;  // NaN compares false with everything
    const std::string joint = std::string(what) + " of joint " + std::to_string(i + 1);
    if (!std::isfinite(values[i])) return Error{RtdeError::value_not_finite, joint};
    return Error{RtdeError::value_out_of_range, joint + " is " + std::to_string(values[i])};
  }
  return std::nullopt;
}

bool arm_has_power(const rtde::RobotState& state) {
  return state.is(RobotMode::idle) || state.is(RobotMode::backdrive) || state.is(RobotMode::running);
}

}  // namespace

std::vector<std::byte> UrRtdeCodec::begin() {
  framer_.reset();
  phase_ = Phase::protocol;
  protocol_ = 2;
  controller_version_.clear();
  last_text_.clear();
  clock_s_.reset();
  return rtde::ask_for_protocol(2);
}

CodecOutput UrRtdeCodec::decode(std::span<const std::byte> bytes, Clock::time_point received) {
  CodecOutput output;
  while (!bytes.empty() && !output.broken) {
    if (!framer_.inside_package()) package_begun_ = received;
    const auto taken = framer_.take(bytes);
    if (!taken) {
      output.broken = taken.error();
      break;
    }
    if (taken->package)
      if (const Status read = take(*taken->package, output); !read) output.broken = read.error();
    bytes = bytes.subspan(taken->consumed);
  }
  return output;
}

Status UrRtdeCodec::take(const rtde::Package& package, CodecOutput& output) {
  switch (package.type) {
    case rtde::kText:
      last_text_ = rtde::read_text(protocol_, package.payload);
      ++output.skipped;
      return Done{};
    case rtde::kPause:
      ++output.skipped;
      return Done{};
    case rtde::kData:
      if (phase_ == Phase::streaming) return on_data(package.payload, output);
      ++output.skipped;
      return Done{};
    default:
      return take_reply(package, output);
  }
}

Status UrRtdeCodec::take_reply(const rtde::Package& package, CodecOutput& output) {
  constexpr std::array kAwaited{rtde::kProtocolVersion, rtde::kControllerVersion, rtde::kSetupOutputs,
                                rtde::kStart, rtde::kData};
  const char awaited = kAwaited[static_cast<std::size_t>(phase_)];
  if (package.type != awaited)
    return Error{RtdeError::unexpected_package, "package type " +
                                                    std::to_string(static_cast<unsigned char>(package.type)) +
                                                    ", '" + awaited + "' is awaited"};
  ++output.messages;
  output.joints_problem = Error{RtdeError::handshake_unfinished, std::string("answered '") + awaited + "'"};
  if (phase_ == Phase::controller_version) return on_controller_version(package.payload, output);
  if (phase_ == Phase::outputs) return on_outputs(package.payload, output);
  const auto accepted = rtde::read_accepted(package.payload);
  if (!accepted) return accepted.error();
  if (phase_ == Phase::protocol) return on_protocol(*accepted, output);
  if (!*accepted) return refused(RtdeError::start_refused, "start");
  phase_ = Phase::streaming;
  return Done{};
}

Status UrRtdeCodec::on_protocol(bool accepted, CodecOutput& output) {
  if (accepted) {
    ask(rtde::ask_for_controller_version(), Phase::controller_version, output);
    return Done{};
  }
  if (protocol_ == 1) return refused(RtdeError::protocol_refused, "protocol");
  protocol_ = 1;
  ask(rtde::ask_for_protocol(1), Phase::protocol, output);
  return Done{};
}

Status UrRtdeCodec::on_controller_version(std::span<const std::byte> payload, CodecOutput& output) {
  const auto version = rtde::read_controller_version(payload);
  if (!version) return version.error();
  controller_version_ = version->text();
  std::array<std::string_view, rtde::kAllVariables.size()> names;
  std::ranges::transform(rtde::kAllVariables, names.begin(), rtde::name_of);
  ask(rtde::ask_for_outputs(protocol_, settings_.frequency_hz, names), Phase::outputs, output);
  return Done{};
}

Status UrRtdeCodec::on_outputs(std::span<const std::byte> payload, CodecOutput& output) {
  const auto setup = rtde::read_output_setup(protocol_, payload);
  if (!setup) return setup.error();
  if (const Status types = rtde::check_types(rtde::kAllVariables, setup->types); !types) {
    if (types.error().code != RtdeError::variable_not_found) return types.error();
    return refused(RtdeError::variable_not_found, types.error().detail);
  }
  recipe_ = setup->recipe;
  ask(rtde::ask_to_start(), Phase::start, output);
  return Done{};
}

Status UrRtdeCodec::on_data(std::span<const std::byte> payload, CodecOutput& output) {
  if (protocol_ > 1) {
    if (payload.empty() || std::to_integer<std::uint8_t>(payload[0]) != recipe_)
      return Error{RtdeError::unknown_recipe, "data package of another recipe"};
    payload = payload.subspan(1);
  }
  const auto state = rtde::read_state(rtde::kAllVariables, payload);
  if (!state) return state.error();
  // The controller restarts this interface once while it boots; its clock then begins at 0 again.
  if (clock_s_ && state->timestamp_s < *clock_s_)
    return Error{RtdeError::clock_ran_back,
                 "from " + std::to_string(*clock_s_) + " s to " + std::to_string(state->timestamp_s) + " s"};
  ++output.messages;
  output.status = status_from(*state);
  take_joints(*state, output);
  if (std::isfinite(state->timestamp_s)) clock_s_ = state->timestamp_s;
  return Done{};
}

void UrRtdeCodec::take_joints(const rtde::RobotState& state, CodecOutput& output) {
  if (auto problem = unusable(state)) {
    if (problem->code != RtdeError::arm_without_power) ++output.rejected_values;
    output.joints_problem = std::move(problem);
    return;
  }
  ++output.joint_messages;
  ControllerJoints joints;
  joints.stamp = package_begun_;
  joints.controller_time_s = state.timestamp_s;
  const auto count = static_cast<std::ptrdiff_t>(settings_.joint_count);
  joints.positions_rad.assign(state.positions_rad.begin(), state.positions_rad.begin() + count);
  joints.velocities_rad.assign(state.velocities_rad_s.begin(), state.velocities_rad_s.begin() + count);
  output.joints = std::move(joints);
}

std::optional<Error> UrRtdeCodec::unusable(const rtde::RobotState& state) const {
  if (!arm_has_power(state))
    return Error{RtdeError::arm_without_power, "robot mode " + std::to_string(state.mode)};
  if (!std::isfinite(state.timestamp_s)) return Error{RtdeError::value_not_finite, "timestamp"};
  if (auto wrong = check_values("position", state.positions_rad, settings_.max_position_rad)) return wrong;
  if (auto wrong = check_values("velocity", state.velocities_rad_s, settings_.max_velocity_rad_s))
    return wrong;
  if (clock_s_ && state.timestamp_s <= *clock_s_)
    return Error{RtdeError::clock_stands_still, "timestamp " + std::to_string(state.timestamp_s) + " s"};
  return outside_ranges(state.positions_rad, settings_.joint_ranges);
}

ControllerStatus UrRtdeCodec::status_from(const rtde::RobotState& state) const {
  ControllerStatus status;
  status.stamp = package_begun_;
  // Powering on (4) and what comes before power_off (booting, no controller) say nothing for certain.
  if (arm_has_power(state)) status.drives_powered = true;
  if (state.is(RobotMode::power_off)) status.drives_powered = false;
  status.e_stopped = state.is(SafetyBit::emergency_stop) || state.is(SafetyBit::robot_emergency_stop) ||
                     state.is(SafetyBit::system_emergency_stop);
  status.in_error =
      state.is(SafetyBit::protective_stop) || state.is(SafetyBit::violation) || state.is(SafetyBit::fault);
  status.motion_possible =
      state.is(RobotMode::running) && (state.is(SafetyBit::normal) || state.is(SafetyBit::reduced));
  return status;  // RTDE says neither whether a program moves the robot nor manual or automatic
}

Error UrRtdeCodec::refused(RtdeError error, std::string detail) const {
  if (!controller_version_.empty()) detail += ", controller software " + controller_version_;
  if (!last_text_.empty()) detail += ", the controller says \"" + last_text_ + "\"";
  return {error, std::move(detail)};
}

void UrRtdeCodec::ask(const rtde::Bytes& request, Phase next, CodecOutput& output) {
  output.reply.insert(output.reply.end(), request.begin(), request.end());
  phase_ = next;
}

}  // namespace calibrd
