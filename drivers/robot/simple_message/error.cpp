// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/error.hpp"

#include <string>

namespace calibrd::simple_message {
namespace {

class Category : public std::error_category {
 public:
  const char* name() const noexcept override { return "simple_message"; }

  std::string message(int value) const override {
    switch (static_cast<SimpleMessageError>(value)) {
      case SimpleMessageError::length_out_of_range:
        return "not a simple_message length (12 to 1024): the stream was cut or the port serves something "
               "else; check robot.port when this repeats";
      case SimpleMessageError::peer_is_little_endian:
        return "set robot.byte_order = \"little\"";
      case SimpleMessageError::peer_is_big_endian:
        return "set robot.byte_order = \"big\"";
      case SimpleMessageError::invalid_header:
        return "not a simple_message header; check that robot.port is the controller's state port";
      case SimpleMessageError::wrong_body_size:
        return "the message does not have the size of its type; check the controller's driver version";
      case SimpleMessageError::peer_sends_float64:
        return "the controller sends 8-byte reals: set robot.real_bytes = 8";
      case SimpleMessageError::peer_sends_float32:
        return "the controller sends 4-byte reals: set robot.real_bytes = 4";
      case SimpleMessageError::group_count_out_of_range:
        return "a controller has 0 to 4 groups; check the controller's driver version";
      case SimpleMessageError::value_not_finite:
        return "not a number; the message was dropped. Check the controller's alarms and encoders";
      case SimpleMessageError::value_out_of_range:
        return "no joint can be there; the message was dropped. Check the controller, and robot.max_position "
               "if the axis really goes that far";
    }
    return "unknown simple_message error";
  }
};

}  // namespace

std::error_code make_error_code(SimpleMessageError error) {
  static const Category category;
  return {static_cast<int>(error), category};
}

bool breaks_stream(const std::error_code& code) {
  return code && code != SimpleMessageError::value_not_finite &&
         code != SimpleMessageError::value_out_of_range;
}

}  // namespace calibrd::simple_message
