// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>

#include "drivers/sim/controller/motion_messages.hpp"
#include "drivers/sim/world/controller_settings.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// Why the controller takes no motion now, as MotoROS numbers it; 0: it does.
std::int32_t not_ready_subcode(const WorldState& world, const ControllerSettings& settings,
                               std::int64_t now_ns);

/// The motion port of MotoROS 1, from request to answer, without sockets: what a command does to the robot.
class MotionCommands {
 public:
  struct Answer {
    MotionReplyRecord reply;
    bool hangs_up = false;  ///< no answer is sent, the connection is closed
  };

  /// Changes `world` and, where trajectory mode begins or ends, `settings`.
  Answer obey(const MotionRequest& request, WorldState& world, ControllerSettings& settings,
              std::int64_t now_ns);

  /// How often each command came; 14: trajectory points.
  const std::map<std::int32_t, std::int32_t>& counts() const { return counts_; }

 private:
  std::map<std::int32_t, std::int32_t> counts_;
  double last_point_s_ = 0;
};

/// There are points left that the robot has not come to.
bool has_queue(const WorldState& world, std::int64_t now_ns);

}  // namespace calibrd::sim
