// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "drivers/robot/simple_message/wire.hpp"

/// The messages of ROS-Industrial's simple_message protocol (REP-I0004) and of MotoROS 1 that a reader of
/// robot state meets. Plain values; positions in rad (m for linear axes), speeds per second.
namespace calibrd::simple_message {

enum class CommType : std::int32_t { topic = 1, service_request = 2, service_reply = 3 };
enum class ReplyCode : std::int32_t { none = 0, success = 1, failure = 2 };

struct Ping {
  static constexpr std::int32_t kType = 1;
  static void fields(auto&, auto&&) {}
};

struct JointPosition {
  static constexpr std::int32_t kType = 10;
  std::int32_t sequence = 0;
  JointValues positions{};

  static void fields(auto& self, auto&& visit) { visit(self.sequence, self.positions); }
};

/// Tri-states: 1 true, 0 false, -1 unknown. Fields in wire order.
struct RobotStatus {
  static constexpr std::int32_t kType = 13;
  std::int32_t drives_powered = -1;
  std::int32_t e_stopped = -1;
  std::int32_t error_code = 0;  ///< 0 none, else the maker's alarm number
  std::int32_t in_error = -1;
  std::int32_t in_motion = -1;
  std::int32_t mode = -1;  ///< 1 manual (teach), 2 automatic (play)
  std::int32_t motion_possible = -1;

  static void fields(auto& self, auto&& visit) {
    visit(self.drives_powered, self.e_stopped, self.error_code, self.in_error, self.in_motion, self.mode,
          self.motion_possible);
  }
};

/// Which of time, positions, velocities and accelerations a sender has filled in. Other bits are reserved,
/// and real senders put rubbish there (ros-industrial/motoman#112): decoding masks them away.
enum ValidField : std::int32_t {
  kValidTime = 1,
  kValidPositions = 2,
  kValidVelocities = 4,
  kValidAccelerations = 8,
  kValidMask = 15
};

struct JointFeedback {
  static constexpr std::int32_t kType = 15;
  std::int32_t robot_id = 0;  ///< the group, from 0
  std::int32_t valid_fields = 0;
  double time_s = 0;
  JointValues positions{};
  JointValues velocities{};
  JointValues accelerations{};

  static void fields(auto& self, auto&& visit) {
    visit(self.robot_id, self.valid_fields, self.time_s, self.positions, self.velocities, self.accelerations);
  }
};

struct JointTrajectoryPointFull {
  static constexpr std::int32_t kType = 14;
  std::int32_t robot_id = 0;
  std::int32_t sequence = 0;
  std::int32_t valid_fields = 0;
  double time_s = 0;
  JointValues positions{};
  JointValues velocities{};
  JointValues accelerations{};

  static void fields(auto& self, auto&& visit) {
    visit(self.robot_id, self.sequence, self.valid_fields, self.time_s, self.positions, self.velocities,
          self.accelerations);
  }
};

/// Always four records on the wire; only the first `group_count` of them mean anything.
struct JointFeedbackEx {
  static constexpr std::int32_t kType = 2017;
  static constexpr std::size_t kRecords = 4;
  std::int32_t group_count = 0;  ///< 0..4
  std::array<JointFeedback, kRecords> records{};

  static void fields(auto& self, auto&& visit) { visit(self.group_count, self.records); }
};

/// Known so that captures and tests can be read. calibrd never sends one.
struct MotionControl {
  static constexpr std::int32_t kType = 2001;
  std::int32_t group = 0;
  std::int32_t sequence = 0;
  std::int32_t command = 0;
  JointValues data{};

  static void fields(auto& self, auto&& visit) { visit(self.group, self.sequence, self.command, self.data); }
};

struct MotionReply {
  static constexpr std::int32_t kType = 2002;
  std::int32_t group = 0;
  std::int32_t sequence = 0;
  std::int32_t command = 0;
  std::int32_t result = 0;
  std::int32_t subcode = 0;
  JointValues data{};

  static void fields(auto& self, auto&& visit) {
    visit(self.group, self.sequence, self.command, self.result, self.subcode, self.data);
  }
};

/// A well-framed message of a type not listed here, body as it came.
struct OtherMessage {
  std::int32_t type = 0;
  std::vector<std::byte> body;
};

/// OtherMessage first, the listed types after it.
using Body = std::variant<OtherMessage, Ping, JointPosition, RobotStatus, JointFeedback,
                          JointTrajectoryPointFull, JointFeedbackEx, MotionControl, MotionReply>;

struct Message {
  CommType comm_type = CommType::topic;
  ReplyCode reply_code = ReplyCode::none;
  Body body;
};

}  // namespace calibrd::simple_message
