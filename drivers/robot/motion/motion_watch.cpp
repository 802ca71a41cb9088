// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_watch.hpp"

#include <cmath>

#include "drivers/robot/motion/motion_error.hpp"

namespace calibrd {
namespace {

bool strayed(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  if (a.size() != b.size()) return true;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > tolerance) return true;
  return false;
}

/// What the status says against moving; a state that is not known counts as the bad one.
std::optional<MotionError> objection(const ControllerStatus& status) {
  if (status.e_stopped != false) return MotionError::e_stopped;
  if (status.in_error != false) return MotionError::in_error;
  if (status.mode != ControllerStatus::Mode::automatic) return MotionError::not_automatic;
  if (status.drives_powered != true) return MotionError::drives_off;
  if (status.motion_possible != true) return MotionError::motion_not_possible;
  return std::nullopt;
}

}  // namespace

void MotionWatch::take(const ControllerJoints& joints) {
  const bool gap = !joints_ || joints.stamp - joints_->stamp > settings_.stale_after;
  if (gap || strayed(joints.positions_rad, rest_rad_, settings_.rest_tolerance_rad)) {
    rest_rad_ = joints.positions_rad;
    rest_since_ = joints.stamp;
  }
  joints_ = joints;
}

void MotionWatch::take(const ControllerStatus& status) {
  const bool gap = !status_ || status.stamp - status_->stamp > settings_.stale_after;
  if (gap || status.in_motion != false) rest_since_ = status.stamp;
  status_ = status;
}

std::optional<Error> MotionWatch::doubt(Clock::time_point now) const {
  if (health_.state != RobotLinkHealth::State::streaming)
    return Error{MotionError::link_down, health_.reason};
  if (!joints_ || now - joints_->stamp > settings_.stale_after) return Error{MotionError::joints_stale, {}};
  if (!status_ || now - status_->stamp > settings_.stale_after) return Error{MotionError::status_stale, {}};
  if (const auto against = objection(*status_)) return Error{*against, {}};
  return std::nullopt;
}

std::optional<Error> MotionWatch::doubt_before_start(Clock::time_point now) const {
  if (auto against = doubt(now)) return against;
  if (!stands()) return Error{MotionError::in_motion, {}};
  if (!rest_since_ || now - *rest_since_ < settings_.rest) return Error{MotionError::not_at_rest, {}};
  return std::nullopt;
}

}  // namespace calibrd
