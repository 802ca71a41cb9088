// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/robot/state_client_settings.hpp"
#include "drivers/robot/state_codec.hpp"

namespace calibrd {

/// A kind of controller: what `robot.driver` chooses. A new one is a codec with its tests, and its line here.
struct RobotDriver {
  std::string_view name;
  int default_port;
  int max_joints;  ///< what its messages carry; the default of joint_count
  std::unique_ptr<StateCodec> (*make_codec)(const StateClientSettings& settings);
};

std::span<const RobotDriver> robot_drivers();
std::vector<std::string> robot_driver_names();

/// Null when there is none of this name.
const RobotDriver* find_robot_driver(std::string_view name);

}  // namespace calibrd
