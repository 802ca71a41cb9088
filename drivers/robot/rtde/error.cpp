// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/error.hpp"

#include <string>

namespace calibrd::rtde {
namespace {

class Category : public std::error_category {
 public:
  const char* name() const noexcept override { return "rtde"; }

  std::string message(int value) const override {
    switch (static_cast<RtdeError>(value)) {
      case RtdeError::size_out_of_range:
        return "not an RTDE package: the stream was cut or the port serves something else; check that "
               "robot.port "
               "is the RTDE port (30004)";
      case RtdeError::unexpected_package:
        return "not what RTDE answers here; check that robot.port is the RTDE port (30004)";
      case RtdeError::wrong_payload_size:
        return "the package does not have the size of its type; check that robot.port is the RTDE port "
               "(30004)";
      case RtdeError::protocol_refused:
        return "the controller refuses RTDE protocol 2 and 1: update its software";
      case RtdeError::variable_not_found:
        return "the controller does not know this variable, so it cannot be read by RTDE: update its "
               "software";
      case RtdeError::variable_of_other_type:
        return "the controller gives this variable in a form that calibrd does not know; report it with the "
               "version "
               "of the controller's software";
      case RtdeError::start_refused:
        return "the controller refuses to send: look at its log on the teach pendant";
      case RtdeError::unknown_recipe:
        return "data nobody asked for; connecting anew";
      case RtdeError::clock_ran_back:
        return "the controller's clock ran back: it has restarted, or is booting; connecting anew";
      case RtdeError::handshake_unfinished:
        return "the controller has not begun to send yet; restart it when this lasts";
      case RtdeError::clock_stands_still:
        return "the controller repeats itself: its clock stands still, and the message was dropped. Look at "
               "the teach "
               "pendant; restart the controller when this lasts";
      case RtdeError::arm_without_power:
        return "without power on the arm its joints cannot be measured: switch it on at the teach pendant";
      case RtdeError::value_not_finite:
        return "not a number; the message was dropped. Look at the teach pendant";
      case RtdeError::value_out_of_range:
        return "no joint can be there; the message was dropped. Check the controller, and robot.max_position "
               "or "
               "robot.max_velocity if the axis really goes that far";
    }
    return "unknown RTDE error";
  }
};

}  // namespace

std::error_code make_error_code(RtdeError error) {
  static const Category category;
  return {static_cast<int>(error), category};
}

}  // namespace calibrd::rtde
