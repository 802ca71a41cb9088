// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "api/http/http_server.hpp"
#include "api/service/reports.hpp"
#include "drivers/robot/joint_source.hpp"
#include "drivers/sensor/depth_source.hpp"

namespace calibrd {

// What happens in the cell, as lines of the log.
/// That it was asked for.
void log_calibration_start(const api::CalibrationReport& calibration);
/// A warning unless it has succeeded or was cancelled.
void log_calibration(const api::CalibrationReport& calibration);
void log_error(const std::string& message);
/// What is done to the robot: every command.
void log_motion(const std::string& line, bool is_well);
/// Of tokens and doors.
void log_security(const std::string& message, bool is_well);
void log_storage(const api::StorageReport& storage);
void log_pose(const api::PoseReport& pose);
/// Threads that must go on and do not; none: all go on again.
void log_stall(const std::vector<std::string>& threads);
void log_access(const api::AccessRecord& record);

/// The events, with every change of the link's health logged.
RobotLinkEvents logged_link(RobotLinkEvents events);

/// A depth source that logs every change of its health.
class LoggedSource : public DepthSource {
 public:
  LoggedSource(std::string id, std::unique_ptr<DepthSource> source);
  std::optional<DepthFrame> next(std::chrono::milliseconds timeout) override;
  SensorHealth health() const override { return source_->health(); }

 private:
  const std::string id_;
  const std::unique_ptr<DepthSource> source_;
  SensorHealth last_;  // the reader's
};

}  // namespace calibrd
