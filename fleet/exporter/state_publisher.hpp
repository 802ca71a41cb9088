// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "api/service/cell_service.hpp"
#include "fleet/exporter/name_guard.hpp"
#include "fleet/exporter/payloads.hpp"
#include "fleet/messages/topics.hpp"

namespace calibrd::fleet {

/// Hands a retained message on. False: it could not be taken now.
using PublishRetained = std::function<bool(const std::string& topic, const std::string& payload,
                                           std::optional<std::chrono::seconds> expiry)>;

/// Tells what has changed of poses and states since it last looked. What holds only while the daemon lives is
/// told again and again, and the broker forgets it when that ends: a message that outlives what it says would
/// be a wrong pose. One thread at a time.
class StatePublisher {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `service` must outlive it.
  StatePublisher(const api::CellService& service, CellTopics topics, Teller teller);

  /// Poses and states only with a clear voice; with a contested one none is valid.
  void look(const PublishRetained& publish, Voice voice, Time now);

  /// The last words: no pose is valid, nothing is known of a sensor, and then that the cell is offline. They
  /// stay.
  void end(const PublishRetained& publish) const;

  /// There is another connection. The broker may know nothing of what was told.
  void forget();

 private:
  struct Told {
    std::string payload;
    Time at;
  };
  void tell(const std::string& topic, std::string payload, const PublishRetained& publish, Time now);
  void tell_pose(const api::PoseReport& pose, const PublishRetained& publish, Time now);

  const api::CellService& service_;
  CellTopics topics_;
  Teller teller_;
  api::SystemTime online_since_;
  std::map<std::string, Told> told_;  // by topic
};

}  // namespace calibrd::fleet
