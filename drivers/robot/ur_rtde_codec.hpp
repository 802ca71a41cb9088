// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/robot/joint_limits.hpp"
#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/rtde/framer.hpp"
#include "drivers/robot/rtde/packages.hpp"
#include "drivers/robot/rtde/recipe.hpp"
#include "drivers/robot/state_codec.hpp"

namespace calibrd {

struct UrRtdeSettings {
  /// Asked for of protocol 2. CB3 controllers reach 125 Hz, e-Series 500 Hz; the joints are interpolated.
  double frequency_hz = 125;
  double max_position_rad = 100;
  double max_velocity_rad_s = 100;
  std::size_t joint_count = rtde::kJointCount;  ///< how many of the six joints are delivered
  std::vector<JointRange> joint_ranges;         ///< per joint, base first; may be shorter than joint_count
};

/// Joints and status of a Universal Robots controller through RTDE (port 30004). What is sent are the
/// requests of the handshake, one after the reply to the other: protocol (2, or 1 where 2 is refused),
/// version of the controller, outputs, start. Nothing that is sent can set or move anything: no inputs are
/// ever set up.
class UrRtdeCodec : public StateCodec {
 public:
  explicit UrRtdeCodec(UrRtdeSettings settings) : settings_(std::move(settings)) {}

  std::vector<std::byte> begin() override;
  CodecOutput decode(std::span<const std::byte> bytes, Clock::time_point received) override;

 private:
  /// The reply that is waited for, or data.
  enum class Phase { protocol, controller_version, outputs, start, streaming };

  Status take(const rtde::Package& package, CodecOutput& output);
  Status take_reply(const rtde::Package& package, CodecOutput& output);
  Status on_protocol(bool accepted, CodecOutput& output);
  Status on_controller_version(std::span<const std::byte> payload, CodecOutput& output);
  Status on_outputs(std::span<const std::byte> payload, CodecOutput& output);
  Status on_data(std::span<const std::byte> payload, CodecOutput& output);
  void take_joints(const rtde::RobotState& state, CodecOutput& output);
  std::optional<Error> unusable(const rtde::RobotState& state) const;
  ControllerStatus status_from(const rtde::RobotState& state) const;
  Error refused(rtde::RtdeError error, std::string detail) const;
  void ask(const rtde::Bytes& request, Phase next, CodecOutput& output);

  UrRtdeSettings settings_;
  rtde::Framer framer_;
  Clock::time_point package_begun_{};
  Phase phase_ = Phase::protocol;
  int protocol_ = 2;
  std::string controller_version_, last_text_;
  std::uint8_t recipe_ = 0;
  std::optional<double> clock_s_;  // of the last data package
};

}  // namespace calibrd
