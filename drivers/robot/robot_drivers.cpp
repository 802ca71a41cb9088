// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/robot_drivers.hpp"

#include <algorithm>
#include <array>

#include "drivers/robot/simple_message_codec.hpp"
#include "drivers/robot/ur_rtde_codec.hpp"

namespace calibrd {
namespace {

std::unique_ptr<StateCodec> make_simple_message(const StateClientSettings& settings) {
  return std::make_unique<SimpleMessageCodec>(
      SimpleMessageSettings{{settings.byte_order, static_cast<std::size_t>(settings.real_bytes)},
                            {settings.max_position, settings.max_velocity},
                            settings.group,
                            static_cast<std::size_t>(settings.joint_count),
                            settings.joint_ranges});
}

std::unique_ptr<StateCodec> make_ur_rtde(const StateClientSettings& settings) {
  UrRtdeSettings rtde;
  rtde.max_position_rad = settings.max_position;
  rtde.max_velocity_rad_s = settings.max_velocity;
  rtde.joint_count = static_cast<std::size_t>(settings.joint_count);
  rtde.joint_ranges = settings.joint_ranges;
  return std::make_unique<UrRtdeCodec>(rtde);
}

constexpr std::array kDrivers{
    RobotDriver{"simple_message", 50241, simple_message::kJointCount, make_simple_message},
    RobotDriver{"ur_rtde", 30004, rtde::kJointCount, make_ur_rtde},
};

}  // namespace

std::span<const RobotDriver> robot_drivers() { return kDrivers; }

std::vector<std::string> robot_driver_names() {
  std::vector<std::string> names(kDrivers.size());
  std::ranges::transform(kDrivers, names.begin(),
                         [](const RobotDriver& driver) { return std::string(driver.name); });
  return names;
}

const RobotDriver* find_robot_driver(std::string_view name) {
  const auto* found = std::ranges::find(kDrivers, name, &RobotDriver::name);
  return found == kDrivers.end() ? nullptr : found;
}

}  // namespace calibrd
