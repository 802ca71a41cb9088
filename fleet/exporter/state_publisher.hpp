// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "api/service/cell_service.hpp"
#include "fleet/messages/topics.hpp"

namespace calibrd::fleet {

/// Hands a retained message on. False: it could not be taken now.
using PublishRetained =
    std::function<bool(const std::string& topic, const std::string& payload, std::optional<std::chrono::seconds> expiry)>;

/// Tells what has changed of poses and states since it last looked. A valid pose is told again before the broker forgets
/// it: a message that outlives what it says would be a wrong pose. One thread at a time.
class StatePublisher {
 public:
  /// `service` must outlive it.
  StatePublisher(const api::CellService& service, CellTopics topics, std::string cell);

  void look(const PublishRetained& publish);

  /// The broker may know nothing of what was told.
  void forget() { told_.clear(); }

 private:
  struct Told {
    std::string payload;
    std::chrono::steady_clock::time_point at;
  };
  void tell_pose(const api::PoseReport& pose, const PublishRetained& publish);
  void tell_state(const api::SensorReport& sensor, const api::PoseReport& pose, const PublishRetained& publish);

  const api::CellService& service_;
  CellTopics topics_;
  std::string cell_;
  std::map<std::string, Told> told_;  // by topic
};

}  // namespace calibrd::fleet
