// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/robot_link_error.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace calibrd {
namespace {

using enum RobotLinkError;

constexpr std::pair<RobotLinkError, std::string_view> kMessages[] = {
    {host_missing, "no controller is named: set robot.host to its address or name"},
    {driver_unknown, "no such driver: set robot.driver to one that docs/controllers.md names"},
    {port_out_of_range,
     "not a TCP port: set robot.port to the controller's state port (MotoROS 50241, FANUC and ABB "
     "11002, Universal Robots 30004)"},
    {port_commands_the_robot,
     "this port commands the robot and connecting could disturb whoever controls it: set robot.port to "
     "the state port (MotoROS 50241, FANUC and ABB 11002, Universal Robots 30004)"},
    {group_out_of_range,
     "a controller has groups 0 to 3: set robot.group to one of them (the first robot is 0)"},
    {joint_count_out_of_range,
     "simple_message carries 1 to 10 joints, RTDE 1 to 6: set robot.joint_count to the axes of the robot"},
    {real_bytes_invalid,
     "reals take 4 or 8 bytes: set robot.real_bytes to 4 unless the controller is known to send 8"},
    {limit_invalid, "a limit must be a positive number: correct or remove it"},
    {joint_range_invalid, "a joint range needs lower < upper, and one range per joint at most: correct it"},
    {interval_invalid,
     "intervals must be positive, stale_after below reconnect_after, backoff_first not above backoff_cap: "
     "correct it"},

    {connecting, "connecting to the controller"},
    {stopped, "calibrd has stopped reading the controller; start it again"},
    {host_unknown, "no such host: check robot.host, or use the controller's IP address"},
    {refused,
     "the controller refuses the connection: its state port opens only when its driver (MotoROS, "
     "ros_state, RTDE) runs and boot alarms are cleared; check the pendant, then robot.port"},
    {unreachable, "no route to the controller: check cable, network settings and robot.host"},
    {no_answer, "the controller does not answer: check that it is switched on, its cable, and robot.host"},
    {connect_failed, "cannot connect: check the network of this machine and robot.host"},

    {closed_by_controller,
     "the controller closed the connection; reconnecting. When this repeats, look for other clients of its "
     "state port"},
    {connection_failed, "the connection broke; reconnecting. When this repeats, check cable and switch"},
    {evicted,
     "the controller closes the connection soon after accepting it: other clients fight for its few "
     "state slots (MotoROS has 4). Close clients that are not needed; trying again only after a long "
     "pause"},
    {silent,
     "the controller sends nothing: reconnecting. Check that it is switched on, its cable, that its "
     "driver (MotoROS, ros_state, RTDE) still runs, and that no other client holds its only place "
     "(FANUC, ABB)"},
    {held_up,
     "this computer was too busy to read the robot for seconds; joints of unknown age were dropped, "
     "reconnecting. Give calibrd more processor time"},
    {out_of_resources,
     "this computer had no memory or no thread left for the link; reconnecting. Look for what uses them up, "
     "or raise the limits of calibrd"},

    {joints_missing,
     "status arrives but no joint positions: the controller cannot read its encoders. Check its alarms and "
     "that the robot's group is enabled"},
    {only_other_groups, "set robot.group to the group of the robot to be calibrated against"},
    {no_positions, "joint messages come without positions: check the version of the controller's driver"},
    {outside_joint_range,
     "outside the range of this joint; the message was dropped. Check the joint order, the joint mapping and "
     "the model's limits"},
};

class Category : public std::error_category {
 public:
  const char* name() const noexcept override { return "robot_link"; }

  std::string message(int value) const override {
    for (const auto& [error, text] : kMessages) {
      if (static_cast<int>(error) == value) return std::string(text);
    }
    return "unknown robot link error";
  }
};

const Category& category() {
  static const Category instance;
  return instance;
}

}  // namespace

std::error_code make_error_code(RobotLinkError error) { return {static_cast<int>(error), category()}; }

std::error_code explain_connect_failure(const std::error_code& foreign) {
  if (foreign.category() == category()) return foreign;
  if (foreign == std::errc::connection_refused) return refused;
  if (foreign == std::errc::timed_out) return no_answer;
  if (foreign == std::errc::host_unreachable || foreign == std::errc::network_unreachable ||
      foreign == std::errc::network_down) {
    return unreachable;
  }
  return connect_failed;
}

}  // namespace calibrd
