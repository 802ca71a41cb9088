// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "api/service/reports.hpp"
#include "core/calibration/check_pose.hpp"
#include "core/sensing/images.hpp"

namespace calibrd {

struct PoseWatchSettings {
  Clock::duration max_unverified = std::chrono::seconds(60);
  Clock::duration check_period = std::chrono::seconds(1);
  Clock::duration recheck_period = std::chrono::milliseconds(100);  ///< while a check has just disagreed
  int disagreements_to_drift = 5;                                   ///< in a row, and
  Clock::duration least_drift = std::chrono::seconds(3);            ///< ... over so long: nobody passing by
};

/// Decides what a sensor's pose is worth from the checks of it. Without I/O; not thread-safe.
///
/// One check that disagrees is enough to serve the pose as valid no longer, and one that agrees well, or many
/// that agree only just, brings it back. Only a row of disagreements calls it drifted, and that stays: that a
/// pose which is off agrees now and then, in one posture or another, does not make it true. Only another
/// pose, or the same one set again, ends it.
class PoseWatch {
 public:
  explicit PoseWatch(const PoseWatchSettings& settings) : settings_(settings) {}

  /// A calibration just accepted: its own views are the first check, at `seen_at`.
  void set_fresh(Clock::time_point seen_at);
  /// A stored pose: unverified until a check agrees.
  void set_stored();
  /// A stored pose that had drifted.
  void set_drifted();
  /// A stored pose that no check can make valid, because it was found for something else: `objection`.
  void set_withheld(std::string objection);
  /// The sensor may have been moved while it was away: a valid pose is unverified until a check agrees.
  void on_sensor_lost();

  /// The sensor sees the background where it was when the pose was found: that is a check, too, unless the
  /// robot has disagreed. While it goes on a disagreeing robot is off, not the sensor.
  void on_background_in_place(Clock::time_point now);
  /// Neither the background nor the robot has been seen where the pose says for a while: a valid pose is
  /// unverified until one of them is.
  void on_view_lost();
  /// Postures on end have spoken against the pose, and the background does not say that it is the robot's
  /// model: a posture that agrees proves nothing until that ends.
  void on_contested(bool is_contested);
  /// The background says that the sensor has moved.
  void on_sensor_moved();

  bool is_check_due(Clock::time_point now) const;
  void on_check(const PoseCheck& check, Clock::time_point now);

  api::PoseState state() const { return state_; }
  /// There is a pose, and it is not known to be wrong: neither drifted nor found for something else.
  bool is_plausible() const;
  /// Calibrated, and the last agreeing check is younger than max_unverified.
  bool is_valid(Clock::time_point now) const;
  /// Why the pose is not valid and what to do; empty while it is.
  std::string reason(Clock::time_point now) const;

  std::optional<api::CheckReport> last_check(Clock::time_point now) const;
  std::optional<api::Seconds> passed_check_age(Clock::time_point now) const;

 private:
  void agree(const PoseCheck& check, Clock::time_point now);
  std::string doubt() const;
  std::string drift() const;
  void disagree(Clock::time_point now);

  PoseWatchSettings settings_;
  api::PoseState state_ = api::PoseState::uncalibrated;
  enum class Doubt { restored, sensor_lost, view_lost, disagreement, robot_off, contested };
  Doubt doubt_ = Doubt::restored;  // why it is unverified
  std::string objection_;
  bool is_contested_ = false;
  int disagreements_ = 0, agreements_ = 0;  // in a row
  Clock::time_point disagrees_since_;
  enum class Drift { background_moved, robot_off, stored };
  Drift drift_ = Drift::robot_off;  // why it has drifted
  std::optional<Clock::time_point> in_place_at_;
  std::optional<Clock::time_point> checked_at_, passed_at_, evidence_at_;
  PoseCheck last_;
};

}  // namespace calibrd
