// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/joint_limits.hpp"
#include "drivers/robot/link_machine.hpp"
#include "drivers/robot/simple_message/wire.hpp"

namespace calibrd {

/// The [robot] section of the configuration, as docs/controllers.md explains it.
struct StateClientSettings {
  std::string driver = "simple_message";  ///< see robot_drivers.hpp
  std::string host;                       ///< address or name
  int port = 50241;                       ///< the state port; ports that command a robot are refused
  simple_message::ByteOrder byte_order = simple_message::ByteOrder::big;  ///< simple_message only
  int real_bytes = 4;                                                     ///< 4 or 8; simple_message only
  int group = 0;                                                          ///< from 0; simple_message only
  int joint_count = 10;                  ///< axes of the group; at most what the driver's protocol carries
  double max_position = 100;             ///< rad or m: beyond it a value is damage
  double max_velocity = 100;             ///< per second
  std::vector<JointRange> joint_ranges;  ///< optional, per joint in wire order
  LinkSettings link;
};

/// Every key is usable. Errors: RobotLinkError, detail names the key.
Status check(const StateClientSettings& settings);

}  // namespace calibrd
