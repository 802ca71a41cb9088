// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/state_publisher.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::fleet {
namespace {

// A broker that is slow for some seconds does not make a cell vanish.
constexpr api::Seconds kMostBetween{10};

constexpr const char* kNotWatched =
    "The daemon was stopped; start it again: while it does not run, nothing watches the pose.";
constexpr const char* kContested =
    "Another daemon speaks under this cell's name; give each its own mqtt.cell.";

std::chrono::seconds expiry_of(const api::PoseReport& pose) {
  const auto rest = std::chrono::seconds(std::lround(std::ceil(rest_of_validity(pose).count())));
  return std::clamp(rest, std::chrono::seconds(1), kKept);
}

api::PoseReport not_valid(api::PoseReport pose, const char* reason) {
  pose.valid = false;
  if (pose.state == api::PoseState::calibrated) pose.state = api::PoseState::unverified;
  pose.reason = reason;
  return pose;
}

api::PoseReport unwatched(api::PoseReport pose) {
  pose.job.clear();
  return not_valid(std::move(pose), kNotWatched);
}

api::SensorReport unwatched(api::SensorReport sensor) {
  sensor.health = "lost";
  sensor.reason = "The daemon was stopped; start it again.";
  return sensor;
}

}  // namespace

StatePublisher::StatePublisher(const api::CellService& service, CellTopics topics, Teller teller)
    : service_(service),
      topics_(std::move(topics)),
      teller_(std::move(teller)),
      online_since_(std::chrono::system_clock::now()) {}

void StatePublisher::forget() {
  told_.clear();
  online_since_ = std::chrono::system_clock::now();
}

void StatePublisher::look(const PublishRetained& publish, Voice voice, Time now) {
  tell(topics_.status(), status_payload(teller_, true, online_since_), publish, now);
  if (voice == Voice::waiting) return;
  for (const auto& sensor : service_.sensors()) {
    auto pose = service_.pose(sensor.id);
    if (!pose) continue;
    if (voice == Voice::contested) *pose = not_valid(*std::move(pose), kContested);
    tell_pose(*pose, publish, now);
    if (const auto drift = service_.drift(sensor.id))
      tell(topics_.state(sensor.id), state_payload(teller_.cell, sensor, *pose, *drift), publish, now);
  }
}

void StatePublisher::end(const PublishRetained& publish) const {
  const auto now = std::chrono::system_clock::now();
  for (const auto& sensor : service_.sensors()) {
    const auto last = service_.pose(sensor.id);
    if (!last) continue;
    const auto pose = unwatched(*last);
    publish(topics_.pose(sensor.id), pose_payload(teller_.cell, pose, now), {});
    if (auto drift = service_.drift(sensor.id)) {
      drift->watched = false;
      publish(topics_.state(sensor.id), state_payload(teller_.cell, unwatched(sensor), pose, *drift), {});
    }
  }
  publish(topics_.status(), status_payload(teller_, false, now), {});
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
  auto essence = pose_payload(teller_.cell, pose, clock, false);
  const auto again_after = std::min(kMostBetween, pose.max_unverified / 3);
  const auto known = told_.find(topic);
  const bool is_known = known != told_.end() && known->second.payload == essence;
  if (is_known && (!pose.valid || now - known->second.at < again_after)) return;
  std::optional<std::chrono::seconds> expiry;  // that a pose is not valid may stand for ever
  if (pose.valid) expiry = expiry_of(pose);
  if (publish(topic, pose_payload(teller_.cell, pose, clock), expiry))
    told_[topic] = {std::move(essence), now};
}

}  // namespace calibrd::fleet
