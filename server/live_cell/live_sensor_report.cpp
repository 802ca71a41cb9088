// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What LiveSensor tells of itself.
#include <algorithm>

#include "server/live_cell/live_sensor.hpp"

namespace calibrd {
namespace {

constexpr auto kRateWindow = std::chrono::seconds(2);

const char* name_of(SensorHealth::State state) {
  switch (state) {
    case SensorHealth::State::starting:
      return "starting";
    case SensorHealth::State::streaming:
      return "streaming";
    case SensorHealth::State::lost:
      return "lost";
  }
  return "lost";
}

}  // namespace

api::PoseReport LiveSensor::pose() const {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  const auto worth = worth_at(now);
  api::PoseReport report;
  report.sensor_id = settings_.id;
  report.base_frame = robot_.model().base_link();
  report.controller_frame = robot_.controller_frame();
  report.sensor_frame = settings_.id + "_optical";
  report.state = worth.state();
  report.valid = known_ && worth.is_valid(now);
  report.reason = worth.reason(now);
  report.known = known_;
  if (known_) report.age = now - calibrated_at_;
  report.last_check = watch_.last_check(now);
  report.passed_check_age = watch_.passed_check_age(now);
  report.max_unverified = settings_.watch.max_unverified;
  return report;
}

api::DriftReport LiveSensor::drift() const {
  api::DriftReport report;
  if (monitor_) report = monitor_->report();
  report.sensor_id = settings_.id;
  const std::lock_guard lock(mutex_);
  report.pose_state = worth_at(Clock::now()).state();
  return report;
}

std::optional<Pose> LiveSensor::seen_pose() const {
  const auto seen = monitor_ ? monitor_->sensor_seen() : std::nullopt;
  return seen ? std::optional(seen->T_base_sensor) : std::nullopt;
}

api::SensorReport LiveSensor::report() const {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  SensorHealth health;
  if (source_) health = source_->health();
  api::SensorReport report;
  report.id = settings_.id;
  report.health = name_of(health.state);
  report.reason = health.reason;
  if (health.state == SensorHealth::State::starting && health.reason.empty())
    report.reason = "the device is being opened; this can take some seconds";
  report.device = health.device;
  report.notice = health.notice;
  report.frames = health.frames;
  report.frames_lost = health.frames_lost;
  report.restarts = health.restarts;
  report.frame_rate_hz = frame_rate_hz(now);
  if (!arrivals_.empty()) report.frame_age = now - arrivals_.back();
  report.camera = settings_.camera;
  report.has_image = newest_ && newest_->view.image;
  report.views.usable = verdict_ == FrameVerdict::usable || verdict_ == FrameVerdict::timed;
  report.views.timing_error_m = timing_error_m_;
  report.time_offset = offset_.report(now);
  report.views.code = name_of(verdict_);
  report.views.reason = reason_of(verdict_);
  report.views.moving_views = counts_[static_cast<std::size_t>(FrameVerdict::timed)];
  report.views.views = counts_[static_cast<std::size_t>(FrameVerdict::usable)] + report.views.moving_views;
  for (std::size_t i = 1; i < kFrameVerdicts; ++i)
    if (counts_[i] > 0 && static_cast<FrameVerdict>(i) != FrameVerdict::timed)
      report.views.refused.emplace_back(name_of(static_cast<FrameVerdict>(i)), counts_[i]);
  const auto worth = worth_at(now);
  report.pose_state = worth.state();
  report.pose_valid = known_ && worth.is_valid(now);
  return report;
}

/// What became of the last frame says nothing of a sensor that sends none.
std::string LiveSensor::hindrance() const {
  const auto now = report();
  if (now.health == name_of(SensorHealth::State::streaming)) return now.views.reason;
  return "the sensor is " + now.health + (now.reason.empty() ? "" : ": " + now.reason);
}

double LiveSensor::frame_rate_hz(Clock::time_point now) const {
  const auto first = std::find_if(arrivals_.begin(), arrivals_.end(),
                                  [&](Clock::time_point arrival) { return now - arrival < kRateWindow; });
  if (std::distance(first, arrivals_.end()) < 2) return 0;
  const std::chrono::duration<double> span = arrivals_.back() - *first;
  return span.count() > 0 ? static_cast<double>(std::distance(first, arrivals_.end()) - 1) / span.count() : 0;
}

}  // namespace calibrd
