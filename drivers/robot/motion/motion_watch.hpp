// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/joint_source.hpp"

namespace calibrd {

struct MotionWatchSettings {
  Clock::duration stale_after = std::chrono::milliseconds(250);  ///< joints and status, each
  Clock::duration rest = std::chrono::seconds(1);  ///< the robot stands for so long before anything is sent
  double rest_tolerance_rad = 0.002;               ///< what a joint may stray while it stands
};

/// What the state link tells, as reasons not to move the robot. A state that the controller does not know
/// counts against moving. Not thread-safe.
class MotionWatch {
 public:
  explicit MotionWatch(MotionWatchSettings settings) : settings_(settings) {}

  void take(const ControllerJoints& joints);
  void take(const ControllerStatus& status);
  void take(const RobotLinkHealth& health) { health_ = health; }

  /// Why the robot must not move at `now`; nothing: no doubt. Errors: MotionError.
  std::optional<Error> doubt(Clock::time_point now) const;

  /// The same before the motion port is opened: there must also be rest, because whoever connects while
  /// another client waits throws that client out.
  std::optional<Error> doubt_before_start(Clock::time_point now) const;

  /// The newest; nothing before the first.
  const std::optional<ControllerJoints>& joints() const { return joints_; }
  /// The newest status says that the robot stands.
  bool stands() const { return status_ && status_->in_motion == false; }

 private:
  const MotionWatchSettings settings_;
  RobotLinkHealth health_;
  std::optional<ControllerJoints> joints_;
  std::optional<ControllerStatus> status_;
  std::vector<double> rest_rad_;  // where the robot stands since rest_since_
  std::optional<Clock::time_point> rest_since_;
};

}  // namespace calibrd
