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
  int disagreements_to_drift = 5;                                   ///< in a row
  int agreements_to_recover = 3;                                    ///< in a row, after a drift
};

/// Decides what a sensor's pose is worth from the checks of it. Without I/O; not thread-safe.
///
/// One check that disagrees is enough to serve the pose as valid no longer; only a row of them calls it
/// drifted.
class PoseWatch {
 public:
  explicit PoseWatch(const PoseWatchSettings& settings) : settings_(settings) {}

  /// A calibration just accepted: its own views are the first check, at `seen_at`.
  void set_fresh(Clock::time_point seen_at);
  /// A stored pose: unverified until a check agrees.
  void set_stored();

  bool is_check_due(Clock::time_point now) const;
  void on_check(const PoseCheck& check, Clock::time_point now);

  api::PoseState state() const { return state_; }
  /// Calibrated, and the last agreeing check is younger than max_unverified.
  bool is_valid(Clock::time_point now) const;
  /// Why the pose is not valid and what to do; empty while it is.
  std::string reason(Clock::time_point now) const;

  std::optional<api::CheckReport> last_check(Clock::time_point now) const;
  std::optional<api::Seconds> passed_check_age(Clock::time_point now) const;

 private:
  void agree(Clock::time_point now);
  void disagree();

  PoseWatchSettings settings_;
  api::PoseState state_ = api::PoseState::uncalibrated;
  int agreements_ = 0, disagreements_ = 0;  // in a row
  std::optional<Clock::time_point> checked_at_, passed_at_, evidence_at_;
  PoseCheck last_;
};

}  // namespace calibrd
