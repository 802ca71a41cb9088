// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/event_log.hpp"

#include <spdlog/spdlog.h>

#include "api/json/calibration_result_json.hpp"
#include "api/routes/names.hpp"
#include "core/base/log_scope.hpp"

namespace calibrd {
namespace {

/// What a client sent, fit for one line of a log.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace

void log_calibration_start(const api::CalibrationReport& calibration) {
  const LogScope scope({log_marks().request_id, calibration.id});
  spdlog::info("sensor {}: calibration {} was asked for, {} postures", calibration.sensor_id, calibration.id,
               calibration.postures_wanted);
}

void log_calibration(const api::CalibrationReport& calibration) {
  const auto verdict =
      calibration.result ? std::string(", ") + api::name_of(calibration.result->verdict) : "";
  const bool is_well =
      calibration.status == api::JobStatus::succeeded || calibration.status == api::JobStatus::cancelled;
  const auto level = is_well ? spdlog::level::info : spdlog::level::warn;
  const auto message = calibration.message.empty() ? "" : ". " + calibration.message;
  spdlog::log(level, "sensor {}: calibration {} {}{}{}", calibration.sensor_id, calibration.id,
              api::name_of(calibration.status), verdict, message);
}

void log_error(const std::string& message) { spdlog::error("{}", message); }

void log_motion(const std::string& line, bool is_well) {
  spdlog::log(is_well ? spdlog::level::info : spdlog::level::warn, "{}", line);
}

void log_security(const std::string& message, bool is_well) {
  spdlog::log(is_well ? spdlog::level::info : spdlog::level::warn, "{}", message);
}

void log_storage(const api::StorageReport& storage) {
  if (storage.state == "good")
    spdlog::info("storage: good");
  else
    spdlog::log(storage.ready ? spdlog::level::warn : spdlog::level::err, "storage: {}: {}", storage.state,
                storage.reason);
}

void log_pose(const api::PoseReport& pose) {
  if (pose.valid)
    spdlog::info("sensor {}: the pose of calibration {} is valid", pose.sensor_id,
                 pose.known->calibration_id);
  else
    spdlog::warn("sensor {}: no valid pose ({}): {}", pose.sensor_id, api::name_of(pose.state), pose.reason);
}

void log_stall(const std::vector<std::string>& threads) {
  for (const auto& name : threads)
    spdlog::error("thread {} does not go on; save a support bundle and restart, if no watchdog does", name);
  if (threads.empty()) spdlog::info("all threads go on again");
}

void log_access(const api::AccessRecord& record) {
  const auto level = record.status == 500 ? spdlog::level::err : spdlog::level::debug;
  spdlog::log(level, "{} {} {} {} us", printable(record.method), printable(record.path), record.status,
              record.duration.count());
}

RobotLinkEvents logged_link(RobotLinkEvents events) {
  using State = RobotLinkHealth::State;
  events.on_health = [inner = std::move(events.on_health),
                      last = RobotLinkHealth()](const RobotLinkHealth& health) mutable {
    if (health.state == State::streaming && last.state != State::streaming)
      spdlog::info("robot: joints are coming in");
    else if (health.reason != last.reason && !health.reason.empty())
      spdlog::log(health.connects == 0 ? spdlog::level::info : spdlog::level::warn, "robot: {}",
                  health.reason);
    last = health;
    if (inner) inner(health);
  };
  return events;
}

LoggedSource::LoggedSource(std::string id, std::unique_ptr<DepthSource> source)
    : id_(std::move(id)), source_(std::move(source)) {}

std::optional<DepthFrame> LoggedSource::next(std::chrono::milliseconds timeout) {
  auto frame = source_->next(timeout);
  auto health = source_->health();
  if (health.state == SensorHealth::State::streaming && last_.state != SensorHealth::State::streaming)
    spdlog::info("sensor {}: frames are coming in from {}", id_, health.device);
  else if (health.reason != last_.reason && !health.reason.empty())
    spdlog::warn("{}", health.reason);
  if (health.notice != last_.notice && !health.notice.empty())
    spdlog::warn("sensor {}: {}", id_, health.notice);
  last_ = std::move(health);
  return frame;
}

}  // namespace calibrd
