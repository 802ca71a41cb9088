// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/value_check.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "drivers/robot/simple_message/error.hpp"

namespace calibrd::simple_message {
namespace {

constexpr double kAnyFinite = std::numeric_limits<double>::max();

/// Visits a body and keeps the first complaint about its values.
class ValueCheck {
 public:
  explicit ValueCheck(const ValueLimits& limits) : limits_(limits) {}

  void operator()(const JointPosition& body) { check("position", body.positions, limits_.max_position); }
  void operator()(const JointFeedback& body) { check_motion(body); }
  void operator()(const JointTrajectoryPointFull& body) { check_motion(body); }
  void operator()(const JointFeedbackEx& body) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(body.group_count); ++i)
      check_motion(body.records[i]);
  }
  void operator()(const auto&) {}

  const std::optional<Error>& complaint() const { return complaint_; }

 private:
  void check_motion(const auto& point) {
    if (point.valid_fields & kValidTime) check("time", point.time_s, kAnyFinite);
    if (point.valid_fields & kValidPositions) check("position", point.positions, limits_.max_position);
    if (point.valid_fields & kValidVelocities) check("velocity", point.velocities, limits_.max_velocity);
    if (point.valid_fields & kValidAccelerations) check("acceleration", point.accelerations, kAnyFinite);
  }
  void check(const char* what, const JointValues& values, double limit) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (usable(values[i], limit)) continue;
      return check(std::string(what) + " of joint " + std::to_string(i + 1), values[i], limit);
    }
  }
  void check(const std::string& what, double value, double limit) {
    if (complaint_ || usable(value, limit)) return;
    if (std::isfinite(value)) {
      complaint_ = Error{SimpleMessageError::value_out_of_range, what + " is " + std::to_string(value)};
    } else {
      complaint_ = Error{SimpleMessageError::value_not_finite, what};
    }
  }
  // NaN compares false with everything.
  static bool usable(double value, double limit) { return std::abs(value) <= limit; }

  const ValueLimits& limits_;
  std::optional<Error> complaint_;
};

}  // namespace

Status check_values(const Body& body, const ValueLimits& limits) {
  ValueCheck check(limits);
  std::visit(check, body);
  if (check.complaint()) return *check.complaint();
  return Done{};
}

}  // namespace calibrd::simple_message
