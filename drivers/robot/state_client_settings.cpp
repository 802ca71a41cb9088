// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/state_client_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/robot/robot_drivers.hpp"
#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {
namespace {

// Motion and IO ports of MotoROS and of generic simple_message servers: connecting to one throws out whoever
// controls the robot. Universal Robots: dashboard, and the ports that run what they are sent as a script.
constexpr std::array kPortsThatCommand = {50240, 50242, 11000, 11003, 29999, 30001, 30002, 30003};

Error at(const char* key, RobotLinkError error) { return {error, key}; }

Error at(const char* key, int value, RobotLinkError error) {
  return {error, std::string(key) + " = " + std::to_string(value)};
}

Status check_port(int port) {
  if (port < 1 || port > 65535) return at("robot.port", port, RobotLinkError::port_out_of_range);
  if (std::ranges::find(kPortsThatCommand, port) != kPortsThatCommand.end()) {
    return at("robot.port", port, RobotLinkError::port_commands_the_robot);
  }
  return Done{};
}

bool positive(double limit) { return std::isfinite(limit) && limit > 0; }

Status check_values(const StateClientSettings& settings) {
  const RobotDriver* driver = find_robot_driver(settings.driver);
  if (driver == nullptr) return Error{RobotLinkError::driver_unknown, "robot.driver = " + settings.driver};
  if (settings.real_bytes != 4 && settings.real_bytes != 8) {
    return at("robot.real_bytes", settings.real_bytes, RobotLinkError::real_bytes_invalid);
  }
  if (settings.group < 0 || settings.group > 3) {
    return at("robot.group", settings.group, RobotLinkError::group_out_of_range);
  }
  if (settings.joint_count < 1 || settings.joint_count > driver->max_joints) {
    return at("robot.joint_count", settings.joint_count, RobotLinkError::joint_count_out_of_range);
  }
  if (!positive(settings.max_position)) return at("robot.max_position", RobotLinkError::limit_invalid);
  if (!positive(settings.max_velocity)) return at("robot.max_velocity", RobotLinkError::limit_invalid);
  const auto usable = [](const JointRange& range) { return range.lower < range.upper; };
  if (settings.joint_ranges.size() > static_cast<std::size_t>(settings.joint_count) ||
      !std::ranges::all_of(settings.joint_ranges, usable)) {
    return at("robot.joint_ranges", RobotLinkError::joint_range_invalid);
  }
  return Done{};
}

Status check_intervals(const LinkSettings& link) {
  const auto shortest =
      std::min({link.stale_after, link.connect_timeout, link.backoff_first, link.eviction_pause});
  if (shortest.count() > 0 && link.eviction_within.count() >= 0 && link.stale_after < link.reconnect_after &&
      link.backoff_first <= link.backoff_cap) {
    return Done{};
  }
  return at("robot.link", RobotLinkError::interval_invalid);
}

}  // namespace

Status check(const StateClientSettings& settings) {
  if (settings.host.empty()) return at("robot.host", RobotLinkError::host_missing);
  if (Status port = check_port(settings.port); !port) return port;
  if (Status values = check_values(settings); !values) return values;
  return check_intervals(settings.link);
}

}  // namespace calibrd
