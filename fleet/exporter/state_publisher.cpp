// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/state_publisher.hpp"

#include <algorithm>
#include <cmath>

#include "fleet/exporter/payloads.hpp"

namespace calibrd::fleet {
namespace {

using Steady = std::chrono::steady_clock;

constexpr api::Seconds kMostBetween{10};

}  // namespace

StatePublisher::StatePublisher(const api::CellService& service, CellTopics topics, std::string cell)
    : service_(service), topics_(std::move(topics)), cell_(std::move(cell)) {}

void StatePublisher::look(const PublishRetained& publish) {
  for (const auto& sensor : service_.sensors()) {
    const auto pose = service_.pose(sensor.id);
    if (!pose) continue;
    tell_pose(*pose, publish);
    tell_state(sensor, *pose, publish);
  }
}

void StatePublisher::tell_pose(const api::PoseReport& pose, const PublishRetained& publish) {
  const auto topic = topics_.pose(pose.sensor_id);
  const auto now = std::chrono::system_clock::now();
  auto essence = pose_payload(cell_, pose, now, false);
  const auto again_after = std::min(kMostBetween, pose.max_unverified / 3);
  const auto known = told_.find(topic);
  const bool is_known = known != told_.end() && known->second.payload == essence;
  if (is_known && (!pose.valid || Steady::now() - known->second.at < again_after)) return;
  std::optional<std::chrono::seconds> expiry;
  if (pose.valid) expiry = std::chrono::seconds(std::max(1L, std::lround(std::ceil(rest_of_validity(pose).count()))));
  if (publish(topic, pose_payload(cell_, pose, now), expiry)) told_[topic] = {std::move(essence), Steady::now()};
}

void StatePublisher::tell_state(const api::SensorReport& sensor, const api::PoseReport& pose,
                                const PublishRetained& publish) {
  const auto drift = service_.drift(sensor.id);
  if (!drift) return;
  const auto topic = topics_.state(sensor.id);
  auto payload = state_payload(cell_, sensor, pose, *drift);
  const auto known = told_.find(topic);
  if (known != told_.end() && known->second.payload == payload) return;
  if (publish(topic, payload, {})) told_[topic] = {std::move(payload), Steady::now()};
}

}  // namespace calibrd::fleet
