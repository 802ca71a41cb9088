// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_error.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace calibrd {
namespace {

using enum MotionError;

constexpr std::pair<MotionError, std::string_view> kMessages[] = {
    {port_not_for_motion, "not a motion port: set motion.port to MotoROS's motion port (50240)"},

    {link_down, "the state link is down: look at link of GET /api/v1/robot"},
    {joints_stale, "no fresh joint positions: look at link of GET /api/v1/robot"},
    {status_stale, "no fresh controller status: look at controller of GET /api/v1/robot"},
    {not_automatic, "the controller is not in automatic: set the pendant to PLAY and REMOTE"},
    {e_stopped, "an emergency stop is pressed, or the controller does not say that none is: release it"},
    {in_error, "the controller has an alarm, or does not say that it has none: clear it on the pendant"},
    {drives_off,
     "the drives are off, or the controller does not say that they are on: a person switches them on"},
    {motion_not_possible,
     "the controller does not say that motion is possible: start its ROS job (INIT_ROS) on the pendant"},

    {in_motion,
     "the robot is in motion, or the controller does not say that it is not: wait until it stands"},
    {not_at_rest, "the robot has not stood still long enough to know that nobody else moves it: wait"},
    {moved_since_checked, "the robot has moved since the way was checked: ask again"},

    {connect_failed, "the motion port does not answer: look at the controller, then at motion.port"},
    {closed_by_controller,
     "the controller closed the motion port: another client has it, or its driver ended; find out which"},
    {no_reply, "the controller did not answer a command in time: look at its driver"},
    {reply_unreadable, "what came from the motion port is no answer to what was sent: check motion.port"},
    {refused_by_controller, "the controller refused a command"},
    {busy_too_long, "the controller takes no further points: look at its driver"},
    {off_path,
     "a joint left the commanded path or stopped following it: look at the robot, then at the joint order"},
    {not_arrived, "the robot did not come to rest at the posture in time: look at the robot"},
    {held_up, "this computer was too busy to watch the robot: give calibrd more processor time"},
    {short_of_resources, "this computer ran short of memory or the like: give calibrd more of it"},

    {stop_requested, "stopped on request"},
    {daemon_ends, "stopped because the daemon ends"},
};

class Category : public std::error_category {
 public:
  const char* name() const noexcept override { return "robot_motion"; }

  std::string message(int value) const override {
    for (const auto& [error, text] : kMessages) {
      if (static_cast<int>(error) == value) return std::string(text);
    }
    return "unknown robot motion error";
  }
};

}  // namespace

std::error_code make_error_code(MotionError error) {
  static const Category category;
  return {static_cast<int>(error), category};
}

}  // namespace calibrd
