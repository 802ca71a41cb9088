// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/pose_watch.hpp"

namespace calibrd {

using api::PoseState;

namespace {

/// The background's word holds for so long.
constexpr auto kInPlace = std::chrono::seconds(1);
/// After one that disagreed, a comparison that agrees only just may be chance: a pose that is off by as much
/// as the limit would be good one moment and bad the next. Well within it one is enough, else these on end.
constexpr double kWellWithin_sigmas = 3;
constexpr int kAgreementsOnEnd = 20;

}  // namespace

void PoseWatch::set_fresh(Clock::time_point seen_at) {
  set_stored();
  state_ = PoseState::calibrated;
  passed_at_ = seen_at;
}

void PoseWatch::set_stored() {
  *this = PoseWatch(settings_);
  state_ = PoseState::unverified;
}

void PoseWatch::set_drifted() {
  set_stored();
  state_ = PoseState::drifted;
  drift_ = Drift::stored;
}

void PoseWatch::set_withheld(std::string objection) {
  set_stored();
  objection_ = std::move(objection);
}

void PoseWatch::on_sensor_lost() {
  if (state_ != PoseState::calibrated) return;
  state_ = PoseState::unverified;
  doubt_ = Doubt::sensor_lost;
}

void PoseWatch::on_view_lost() {
  if (state_ != PoseState::calibrated) return;
  state_ = PoseState::unverified;
  doubt_ = Doubt::view_lost;
}

void PoseWatch::on_background_in_place(Clock::time_point now) {
  in_place_at_ = now;
  const bool returned =
      state_ == PoseState::unverified &&
      (doubt_ == Doubt::sensor_lost || doubt_ == Doubt::view_lost || doubt_ == Doubt::contested);
  if (!objection_.empty() || (state_ != PoseState::calibrated && !returned)) return;
  state_ = PoseState::calibrated;
  passed_at_ = now;
}

void PoseWatch::on_contested(bool is_contested) {
  is_contested_ = is_contested;
  if (!is_contested || state_ != PoseState::calibrated) return;
  state_ = PoseState::unverified;
  doubt_ = Doubt::contested;
}

void PoseWatch::on_sensor_moved() {
  if (state_ == PoseState::uncalibrated || state_ == PoseState::drifted) return;
  state_ = PoseState::drifted;
  drift_ = Drift::background_moved;
}

bool PoseWatch::is_check_due(Clock::time_point now) const {
  if (state_ == PoseState::uncalibrated) return false;
  const bool settled = state_ != PoseState::unverified || doubt_ == Doubt::restored ||
                       doubt_ == Doubt::sensor_lost || doubt_ == Doubt::view_lost ||
                       doubt_ == Doubt::contested;
  return !checked_at_ || now - *checked_at_ >= (settled ? settings_.check_period : settings_.recheck_period);
}

void PoseWatch::on_check(const PoseCheck& check, Clock::time_point now) {
  if (state_ == PoseState::uncalibrated) return;
  checked_at_ = now;
  if (!check.enough_evidence) return;
  evidence_at_ = now;
  last_ = check;
  if (!objection_.empty() || state_ == PoseState::drifted) return;
  if (check.agrees && is_contested_) return;
  check.agrees ? agree(check, now) : disagree(now);
}

void PoseWatch::agree(const PoseCheck& check, Clock::time_point now) {
  disagreements_ = 0;
  ++agreements_;
  const bool was_off =
      state_ == PoseState::unverified && (doubt_ == Doubt::disagreement || doubt_ == Doubt::robot_off);
  const bool convinces = check.shift_sigmas < kWellWithin_sigmas || agreements_ >= kAgreementsOnEnd;
  if (was_off && !convinces) return;
  state_ = PoseState::calibrated;
  passed_at_ = now;
}

void PoseWatch::disagree(Clock::time_point now) {
  if (disagreements_ == 0) disagrees_since_ = now;
  ++disagreements_;
  agreements_ = 0;
  const bool lasts = now - disagrees_since_ >= settings_.least_drift;
  // Of a sensor that stands the robot's word is that joints, base or model are wrong.
  const bool stands = in_place_at_ && now - *in_place_at_ < kInPlace;
  state_ = lasts && !stands && disagreements_ >= settings_.disagreements_to_drift ? PoseState::drifted
                                                                                  : PoseState::unverified;
  if (stands) disagreements_ = 0;  // they are of the model, and say nothing of what comes
  drift_ = Drift::robot_off;
  doubt_ = stands ? Doubt::robot_off : Doubt::disagreement;
}

std::string PoseWatch::doubt() const {
  if (!objection_.empty()) return objection_;
  switch (doubt_) {
    case Doubt::sensor_lost:
      return "the sensor was lost, sends nothing new, or has moved since the pose was found; the pose is "
             "checked when frames come and the robot holds still in view";
    case Doubt::view_lost:
      return "for a while the sensor has seen neither the background nor the robot where the pose says; "
             "take away what stands before it, or, if it was moved, calibrate again";
    case Doubt::disagreement:
      return "the last check disagreed with the pose; further checks follow at once";
    case Doubt::robot_off:
      return "the sensor stands, but the robot is not where its joints and the pose put it: check joint "
             "zeros, the robot's base and the model; further checks follow at once";
    case Doubt::contested:
      return "something speaks against the pose, and nothing settles it: one thing in view has shifted, or "
             "the robot has looked off in several postures; if the sensor may have been moved, calibrate "
             "again, else check joint zeros, the robot's base and the model, and let the robot work in view";
    case Doubt::restored:
      break;
  }
  return "no check has passed since the pose was restored or activated; it is checked when the robot holds "
         "still in view";
}

std::string PoseWatch::drift() const {
  switch (drift_) {
    case Drift::background_moved:
      return "the sensor has moved: what stands around the robot, or the robot itself, is no longer where "
             "the pose puts it; calibrate again, or wait for it where drift.healing does so";
    case Drift::robot_off:
      return "the sensor does not see the robot where the pose says; calibrate again, or, if something only "
             "stood before it, activate the calibration again";
    case Drift::stored:
      break;
  }
  return "the pose had drifted before calibrd was started again; calibrate again, or wait for it where "
         "drift.healing does so";
}

bool PoseWatch::is_plausible() const {
  return state_ != PoseState::uncalibrated && state_ != PoseState::drifted && objection_.empty();
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
      return doubt();
    case PoseState::drifted:
      return drift();
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
