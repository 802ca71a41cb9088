// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/state_publisher.hpp"

#include <algorithm>
#include <cmath>

#include "fleet/exporter/payloads.hpp"

namespace calibrd::fleet {
namespace {

// Six tellings: a broker that is slow for some seconds does not make a cell vanish.
constexpr api::Seconds kMostBetween{10};
constexpr std::chrono::seconds kKept{60};

constexpr const char* kNotWatched =
    "The daemon was stopped; start it again: while it does not run, nothing watches the pose.";

std::chrono::seconds expiry_of(const api::PoseReport& pose) {
  const auto rest = std::chrono::seconds(std::lround(std::ceil(rest_of_validity(pose).count())));
  return std::clamp(rest, std::chrono::seconds(1), kKept);
}

api::PoseReport unwatched(api::PoseReport pose) {
  pose.valid = false;
  if (pose.state == api::PoseState::calibrated) pose.state = api::PoseState::unverified;
  pose.reason = kNotWatched;
  pose.job.clear();
  return pose;
}

api::SensorReport unwatched(api::SensorReport sensor) {
  sensor.health = "lost";
  sensor.reason = "The daemon was stopped; start it again.";
  return sensor;
}

}  // namespace

StatePublisher::StatePublisher(const api::CellService& service, CellTopics topics, std::string cell,
                               std::string version)
    : service_(service),
      topics_(std::move(topics)),
      cell_(std::move(cell)),
      version_(std::move(version)),
      online_since_(std::chrono::system_clock::now()) {}

void StatePublisher::forget() {
  told_.clear();
  online_since_ = std::chrono::system_clock::now();
}

void StatePublisher::look(const PublishRetained& publish, Time now) {
  tell(topics_.status(), status_payload(cell_, true, version_, online_since_), publish, now);
  for (const auto& sensor : service_.sensors()) {
    const auto pose = service_.pose(sensor.id);
    if (!pose) continue;
    tell_pose(*pose, publish, now);
    if (const auto drift = service_.drift(sensor.id))
      tell(topics_.state(sensor.id), state_payload(cell_, sensor, *pose, *drift), publish, now);
  }
}

void StatePublisher::end(const PublishRetained& publish) const {
  const auto now = std::chrono::system_clock::now();
  for (const auto& sensor : service_.sensors()) {
    const auto last = service_.pose(sensor.id);
    if (!last) continue;
    const auto pose = unwatched(*last);
    publish(topics_.pose(sensor.id), pose_payload(cell_, pose, now), {});
    if (auto drift = service_.drift(sensor.id)) {
      drift->watched = false;
      publish(topics_.state(sensor.id), state_payload(cell_, unwatched(sensor), pose, *drift), {});
    }
  }
  publish(topics_.status(), status_payload(cell_, false, version_, now), {});
}

void StatePublisher::tell(const std::string& topic, std::string payload, const PublishRetained& publish,
                          Time now) {
  const auto known = told_.find(topic);
  if (known != told_.end() && known->second.payload == payload && now - known->second.at < kMostBetween)
    return;
  if (publish(topic, payload, kKept)) told_[topic] = {std::move(payload), now};
}

void StatePublisher::tell_pose(const api::PoseReport& pose, const PublishRetained& publish, Time now) {
  const auto topic = topics_.pose(pose.sensor_id);
  const auto clock = std::chrono::system_clock::now();
  auto essence = pose_payload(cell_, pose, clock, false);
  const auto again_after = std::min(kMostBetween, pose.max_unverified / 3);
  const auto known = told_.find(topic);
  const bool is_known = known != told_.end() && known->second.payload == essence;
  if (is_known && (!pose.valid || now - known->second.at < again_after)) return;
  std::optional<std::chrono::seconds> expiry;  // that a pose is not valid may stand for ever
  if (pose.valid) expiry = expiry_of(pose);
  if (publish(topic, pose_payload(cell_, pose, clock), expiry)) told_[topic] = {std::move(essence), now};
}

}  // namespace calibrd::fleet
