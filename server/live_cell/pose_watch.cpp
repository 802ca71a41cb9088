// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/pose_watch.hpp"

namespace calibrd {

using api::PoseState;

void PoseWatch::set_fresh(Clock::time_point seen_at) {
  set_stored();
  state_ = PoseState::calibrated;
  passed_at_ = seen_at;
}

void PoseWatch::set_stored() {
  *this = PoseWatch(settings_);
  state_ = PoseState::unverified;
}

bool PoseWatch::is_check_due(Clock::time_point now) const {
  if (state_ == PoseState::uncalibrated) return false;
  const bool settled = state_ != PoseState::unverified || !evidence_at_;
  return !checked_at_ || now - *checked_at_ >= (settled ? settings_.check_period : settings_.recheck_period);
}

void PoseWatch::on_check(const PoseCheck& check, Clock::time_point now) {
  if (state_ == PoseState::uncalibrated) return;
  checked_at_ = now;
  if (!check.enough_evidence) return;
  evidence_at_ = now;
  last_ = check;
  check.agrees ? agree(now) : disagree();
}

void PoseWatch::agree(Clock::time_point now) {
  disagreements_ = 0;
  ++agreements_;
  if (state_ == PoseState::drifted && agreements_ < settings_.agreements_to_recover) return;
  state_ = PoseState::calibrated;
  passed_at_ = now;
}

void PoseWatch::disagree() {
  agreements_ = 0;
  ++disagreements_;
  if (disagreements_ >= settings_.disagreements_to_drift)
    state_ = PoseState::drifted;
  else if (state_ == PoseState::calibrated)
    state_ = PoseState::unverified;
}

bool PoseWatch::is_valid(Clock::time_point now) const {
  return state_ == PoseState::calibrated && passed_at_ && now - *passed_at_ < settings_.max_unverified;
}

std::string PoseWatch::reason(Clock::time_point now) const {
  if (is_valid(now)) return {};
  switch (state_) {
    case PoseState::uncalibrated:
      return "this sensor has never been calibrated; start a calibration";
    case PoseState::unverified:
      return evidence_at_ ? "the last check disagreed with the pose; further checks follow at once"
                          : "no check has passed since the pose was restored; it is checked when the robot "
                            "holds still "
                            "in view";
    case PoseState::drifted:
      return "the sensor does not see the robot where the pose says; if nothing stands before it, calibrate "
             "again";
    case PoseState::calibrated:
      break;
  }
  return "the last passed check is older than pose.max_unverified; let the robot hold still in view of the "
         "sensor";
}

std::optional<api::CheckReport> PoseWatch::last_check(Clock::time_point now) const {
  if (!evidence_at_) return std::nullopt;
  return api::CheckReport{last_.agrees, last_.agreement, last_.median_residual_m, now - *evidence_at_};
}

std::optional<api::Seconds> PoseWatch::passed_check_age(Clock::time_point now) const {
  if (!passed_at_) return std::nullopt;
  return now - *passed_at_;
}

}  // namespace calibrd
