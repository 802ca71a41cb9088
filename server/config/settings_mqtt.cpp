// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/section_declarer.hpp"

namespace calibrd {

void declare_mqtt(std::vector<Setting>& table) {
  SectionDeclarer<MqttConfig> key(table, {"mqtt"}, [](Config& c, const Names&) -> MqttConfig& { return c.mqtt; });
  key("host", &MqttConfig::host, text(), "",
      "Name or address of an MQTT 5 broker that is told poses, states and calibrations: docs/fleet.md. Empty: none.");
  key("port", &MqttConfig::port, integer(0, 65535), "", "Its port. 0: 1883, with mqtt.tls.enabled 8883.");
  key("cell", &MqttConfig::cell, text(), "",
      "Name of this cell, unlike that of any other at the broker; letters, digits, '.', '_' and '-'. Required with host.");
  key("prefix", &MqttConfig::prefix, text(), "", "First level of every topic; the collector must have the same.");
  key("username", &MqttConfig::username, text(), "", "User at the broker. Empty: none.");
  key("password_file", &MqttConfig::password_file, path(), "", "File whose first line is the user's password.");
  SectionDeclarer<MqttTlsConfig> tls(table, {"mqtt", "tls"},
                                     [](Config& c, const Names&) -> MqttTlsConfig& { return c.mqtt.tls; });
  tls("enabled", &MqttTlsConfig::enabled, flag(), "", "Speaks TLS to the broker and checks its certificate.");
  tls("ca", &MqttTlsConfig::ca, path(), "",
      "PEM file: authorities that the broker's certificate may be of. Empty: those of the system.");
  tls("certificate", &MqttTlsConfig::certificate, path(), "",
      "PEM file: certificate of this cell, for a broker that asks for one.");
  tls("key", &MqttTlsConfig::key, path(), "", "PEM file with its key.");
}

}  // namespace calibrd
