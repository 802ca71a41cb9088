// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "api/service/reports.hpp"
#include "core/robot/controller_frame.hpp"
#include "core/robot/joint_mapping.hpp"
#include "core/robot/robot_model.hpp"
#include "drivers/robot/joint_source.hpp"
#include "server/live_cell/joint_history.hpp"
#include "server/live_cell/view_gate.hpp"

namespace calibrd {

/// The robot as its controller reports it: joints of the last seconds in the model's order, status, link
/// health. Safe to call from any thread.
class LiveRobot {
 public:
  /// `model` must outlive it. `stillness`: when the robot counts as still, and its joints as stale. `latency`
  /// is taken off the stamps of joints, which are those of their arrival.
  LiveRobot(const RobotModel& model, JointMapping mapping, ViewGateSettings stillness,
            Clock::duration latency, std::optional<ControllerFrame> controller_frame);

  /// What the link is to be given; the robot must outlive the link.
  RobotLinkEvents events();

  /// Where counters of the link can be read at any time; until then on_health's last word counts.
  void set_health_source(std::function<RobotLinkHealth()> source);

  /// Calls `read` with the history; it must not call back.
  template <class Read>
  auto read_joints(Read read) const {
    const std::lock_guard lock(mutex_);
    return read(history_);
  }

  const RobotModel& model() const { return model_; }
  /// Nothing where none is configured.
  const std::optional<ControllerFrame>& controller_frame() const { return controller_frame_; }
  std::optional<JointState> newest_joints() const;
  /// What the controller is at when the model is at these positions; values of axes that move no joint are
  /// the newest. Errors: JointMappingError.
  Result<std::vector<double>> controller_values(std::span<const double> positions_rad) const;

  /// They are too old, or the controller goes on sending the same ones while it says that it moves.
  bool is_stale(const JointState& joints) const;
  /// Of the link, since start.
  std::uint64_t connects() const;

  /// Also computes where the links are.
  api::RobotReport report() const;

 private:
  void take(const ControllerJoints& joints);

  const RobotModel& model_;
  const JointMapping mapping_;
  const ViewGateSettings stillness_;
  const Clock::duration latency_;
  const std::optional<ControllerFrame> controller_frame_;

  mutable std::mutex mutex_;  // guards what follows
  JointHistory history_;
  std::vector<double> controller_values_;  // newest, as they came
  std::optional<ControllerStatus> status_;
  RobotLinkHealth health_;
  std::function<RobotLinkHealth()> health_source_;
  std::string mapping_problem_;
};

}  // namespace calibrd
