// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "fleet/collector/inbox.hpp"
#include "fleet/collector/warehouse.hpp"
#include "fleet/mqtt/mqtt_client.hpp"

namespace calibrd::fleet {

struct CollectorSettings {
  MqttSettings broker;  ///< without last will
  std::string prefix = "calibrd";
  std::string database;  ///< see Warehouse
};

/// Puts what the cells send into PostgreSQL, and tells each cell what is on its disk: only then does the
/// daemon forget it. Whatever ends in between, broker, database or the collector itself, costs at most that
/// it is sent again.
class Collector {
 public:
  using Log = std::function<void(const std::string& line, bool is_well)>;

  Collector(CollectorSettings settings, Log log);

  /// Works until `is_ending` says so, which is asked several times a second. Error: it could not begin;
  /// MqttError.
  Status run(const std::function<bool()>& is_ending);

 private:
  /// What is refused as it arrives.
  struct Misfit {
    Arrival arrival;
    std::string reason;
  };
  MqttEvents events();
  void receive(const std::string& topic, std::string payload);
  void greet(MqttClient& client);
  void keep(MqttClient& client, std::vector<Arrival> arrivals, const std::function<bool()>& is_ending);
  void keep_one_by_one(MqttClient& client, std::vector<Arrival> arrivals,
                       const std::function<bool()>& is_ending);
  void look_at_database();
  void refuse_misfits(MqttClient& client);
  void pause(const std::function<bool()>& is_ending);
  void acknowledge(MqttClient& client, const std::vector<Arrival>& stored);
  void refuse(MqttClient& client, const Arrival& arrival, const std::string& reason);
  void say_once(const std::string& trouble);

  const CollectorSettings settings_;
  const Log log_;
  Inbox inbox_;
  Warehouse warehouse_;
  bool is_prepared_ = false;
  int pause_ = 0;  // before the next try of the database

  std::mutex mutex_;
  bool is_new_connection_ = false;  // guarded by mutex_
  std::string trouble_;             // guarded by mutex_; what was said last
  std::vector<Misfit> misfits_;     // guarded by mutex_
};

}  // namespace calibrd::fleet
