// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "api/service/motion_reports.hpp"
#include "core/base/result.hpp"
#include "core/planning/next_posture.hpp"
#include "drivers/robot/motion/robot_mover.hpp"
#include "server/live_cell/live_robot.hpp"

namespace calibrd {

struct RobotMotionSettings {
  bool enabled = false;
  double table_height_m = 0;  ///< base frame; no moving link goes below
  std::map<std::string, std::vector<std::vector<double>>> routes_rad;  ///< name -> postures, model's order
};

/// Motions that somebody asks for: one at a time, each checked against the model before it begins, each
/// command logged. Nothing moves without a mover. Safe to call from any thread. Errors: api::ApiError.
class RobotMotions {
 public:
  /// One line about a motion; `is_well` false: it ended otherwise than it should.
  using Log = std::function<void(const std::string& line, bool is_well)>;

  /// `robot` must outlive it.
  RobotMotions(RobotMotionSettings settings, const LiveRobot& robot, Log log)
      : settings_(std::move(settings)), robot_(robot), log_(std::move(log)) {}

  /// Who moves the robot; must outlive every other call, but for those after request_stop().
  void set_mover(RobotMover* mover);

  /// A posture has been suggested: from now on it, and no other, can be approved for this sensor.
  void remember(const std::string& sensor_id, const PostureSuggestion& suggestion);

  Result<api::MotionReport> start(const api::MotionRequest& request);
  api::MotionsReport list() const;
  Result<api::MotionReport> find(std::string_view id) const;
  Result<api::MotionReport> stop(std::string_view id);

  /// Stops what is under way; nothing starts any more.
  void request_stop();

 private:
  using Postures = std::vector<std::vector<double>>;

  Result<Postures> wanted(const api::MotionRequest& request) const;
  Result<MotionOrder> make_order(const Postures& postures) const;
  std::string add_report(const api::MotionRequest& request, std::size_t postures);
  MotionEvents events_of(const std::string& id);
  void update(const std::string& id, const std::function<void(api::MotionReport&)>& change);
  void end(const std::string& id, const MotionEnd& how);
  std::string active() const;

  const RobotMotionSettings settings_;
  const LiveRobot& robot_;
  const Log log_;

  std::mutex starting_;  // one start() at a time

  mutable std::mutex mutex_;  // guards what follows; never held while the mover is called
  RobotMover* mover_ = nullptr;
  bool is_stopping_ = false;
  std::deque<api::MotionReport> reports_;  // newest first
  std::map<std::string, std::vector<double>> suggested_rad_;
  std::mt19937 random_{std::random_device{}()};
};

}  // namespace calibrd
