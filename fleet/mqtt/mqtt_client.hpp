// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "core/base/result.hpp"
#include "fleet/mqtt/mqtt_error.hpp"

namespace calibrd::fleet {

struct MqttSettings {
  std::string host;
  int port = 1883;
  std::string client_id;
  std::string username = {};
  std::filesystem::path password_file = {};
  bool tls = false;
  std::filesystem::path ca = {};                     ///< PEM; empty: the system's authorities
  std::filesystem::path certificate = {}, key = {};  ///< PEM, for a broker that asks for one
  std::string will_topic = {}, will_payload = {};    ///< retained; empty: no last will
};

/// What happens to a connection. Called on the client's thread: be quick, and do not call the client.
struct MqttEvents {
  std::function<void()> on_connect;
  std::function<void(const std::string& why)>
      on_trouble;  ///< not connected, or a message or subscription was refused
  std::function<void(std::string topic, std::string payload)> on_message;
  std::function<void()> on_taken;  ///< the broker has taken one message that was published
};

/// An MQTT 5 connection with QoS 1 to a broker that may come and go, refuse, or throw it out: it connects
/// again by itself, 0.5 to 5 s after it was lost, whatever the reason. Subscriptions, and messages that the
/// broker has not taken, are for one connection. Safe to use from any thread.
class MqttClient {
 public:
  /// Whether there is an address, and the files can be used. Errors: MqttError, with the file or address.
  static Status check(const MqttSettings& settings);

  /// Connects in the background. Files that cannot be used are a trouble, and read again at every attempt.
  /// Errors: MqttError, with the address.
  static Result<std::unique_ptr<MqttClient>> start(const MqttSettings& settings, MqttEvents events);
  ~MqttClient();  ///< as stop()

  /// `expiry`: after it the broker forgets the message, also a retained one. Without a connection:
  /// MqttError::not_sent.
  Status publish(const std::string& topic, const std::string& payload, bool retain,
                 std::optional<std::chrono::seconds> expiry = {});
  /// A broker that refuses it is a trouble: MqttEvents.
  void subscribe(const std::string& topic);

  /// Ends the connection in good order, within about a second: what was published is sent first, the last
  /// will is not, unless the broker did not take all in time. No event comes after it.
  void stop();

 private:
  struct Handle;
  explicit MqttClient(std::shared_ptr<Handle> handle);
  std::shared_ptr<Handle> handle_;
  std::thread thread_;
};

}  // namespace calibrd::fleet
