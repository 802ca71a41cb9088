// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/mqtt/mqtt_error.hpp"

#include <string>

namespace calibrd::fleet {
namespace {

const char* text(MqttError code) {
  switch (code) {
    case MqttError::no_memory:
      return "no memory for an MQTT connection";
    case MqttError::bad_address:
      return "the broker cannot be connected to at all; check host and port";
    case MqttError::bad_tls_file:
      return "a certificate or key for the broker cannot be used; check that the files are PEM, belong "
             "together and "
             "can be read by this user";
    case MqttError::bad_password_file:
      return "the file with the broker's password cannot be read; its first line is the password";
    case MqttError::not_sent:
      return "the message could not be handed to the MQTT library";
  }
  return "unknown MQTT error";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "mqtt"; }
  std::string message(int code) const override { return text(static_cast<MqttError>(code)); }
};

}  // namespace

std::error_code make_error_code(MqttError code) {
  static const Category category;
  return {static_cast<int>(code), category};
}

}  // namespace calibrd::fleet
