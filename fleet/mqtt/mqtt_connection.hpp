// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fleet/mqtt/mqtt_client.hpp"

struct mosquitto;

namespace calibrd::fleet {

/// One connection to a broker, from its beginning to its end; another one is another object. libmosquitto's
/// handle must not outlive it: also with a clean start the library sends what waited in the handle again,
/// long after it was true.
class MqttConnection {
 public:
  /// Reads password and certificates. Errors: MqttError, with the file. Events come on the thread that calls
  /// run().
  static Result<std::unique_ptr<MqttConnection>> make(const MqttSettings& settings, MqttEvents events);
  ~MqttConnection();

  /// Connects, which may wait minutes for a name server or a host that does not answer, and serves the
  /// connection until it has ended: why.
  std::string run();

  // Safe to call from any thread while it runs.

  Status publish(const std::string& topic, const std::string& payload, bool retain,
                 std::optional<std::chrono::seconds> expiry);
  void subscribe(const std::string& topic);
  /// The broker is told that this is the end; run() returns. `with_will`: it sends the last will all the
  /// same.
  void leave(bool with_will);
  /// run() returns without the broker being told, as soon as the connection stands or does not.
  void abandon();
  bool is_up() const { return is_up_; }
  /// Messages that the broker has not taken yet.
  int in_flight() const { return in_flight_; }

 private:
  struct Callbacks;
  explicit MqttConnection(MqttEvents events);
  Status set_up(const MqttSettings& settings);
  std::string serve();
  int step();
  void note_subscription(int number, int reason);
  void subscribe_again();
  void wake() const;
  std::string why(int code) const;

  const MqttEvents events_;
  std::string host_;
  int port_ = 0;
  mosquitto* client_ = nullptr;
  int wake_fd_ = -1;
  std::string refusal_;  // of the broker, for this thread's run()
  int farewell_ = 0;     // the reason that came with the end; run()'s thread
  std::atomic<bool> is_up_ = false, is_abandoned_ = false;
  std::atomic<int> in_flight_ = 0;
  std::mutex mutex_;
  std::map<int, std::string> subscribing_;  // guarded by mutex_; topics by the library's number
  std::vector<std::string> refused_;        // run()'s thread: topics to be subscribed to again
  std::chrono::steady_clock::time_point refused_at_{};
};

}  // namespace calibrd::fleet
