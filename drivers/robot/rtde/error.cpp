// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/error.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace calibrd::rtde {
namespace {

using enum RtdeError;

constexpr std::pair<RtdeError, std::string_view> kMessages[] = {
    {size_out_of_range,
     "not an RTDE package: the stream was cut or the port serves something else; check that robot.port "
     "is the RTDE port (30004)"},
    {unexpected_package, "not what RTDE answers here; check that robot.port is the RTDE port (30004)"},
    {wrong_payload_size,
     "the package does not have the size of its type; check that robot.port is the RTDE port (30004)"},
    {protocol_refused, "the controller refuses RTDE protocol 2 and 1: update its software"},
    {variable_not_found,
     "the controller does not know this variable, so it cannot be read by RTDE: update its software"},
    {variable_of_other_type,
     "the controller gives this variable in a form that calibrd does not know; report it with the "
     "version of the controller's software"},
    {start_refused, "the controller refuses to send: look at its log on the teach pendant"},
    {unknown_recipe, "data nobody asked for; connecting anew"},
    {clock_ran_back, "the controller's clock ran back: it has restarted, or is booting; connecting anew"},
    {handshake_unfinished, "the controller has not begun to send yet; restart it when this lasts"},
    {clock_stands_still,
     "the controller repeats itself: its clock stands still, and the message was dropped. Look at the "
     "teach pendant; restart the controller when this lasts"},
    {arm_without_power,
     "without power on the arm its joints cannot be measured: switch it on at the teach pendant"},
    {value_not_finite, "not a number; the message was dropped. Look at the teach pendant"},
    {value_out_of_range,
     "no joint can be there; the message was dropped. Check the controller, and robot.max_position or "
     "robot.max_velocity if the axis really goes that far"},
};

class Category : public std::error_category {
 public:
  const char* name() const noexcept override { return "rtde"; }

  std::string message(int value) const override {
    for (const auto& [error, text] : kMessages) {
      if (static_cast<int>(error) == value) return std::string(text);
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
