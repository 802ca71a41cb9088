// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/drift_watch.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kGap_s = 1.5;  // between frames: the sensor was away
/// A background that is nowhere for so long: the sensor looks elsewhere; sooner where it is seen from there.
constexpr double kLost_s = 0.5, kElsewhere_s = 0.3;
constexpr int kFoundAgain = 5;      // frames on end that show it where it was
constexpr double kLeastGone = 0.2;  // share of it that lies farther: nobody who stands in front does that
constexpr double kLeastLeft = 0.1;  // share of it that is where it was
/// Where a moved sensor is now is told pixel by pixel only when so much of the background is still where it
/// was: a fit to less settles anywhere.
constexpr double kLeastSame = 0.8;
constexpr int kRealignEvery = 3;  // frames; it takes some milliseconds
/// A background that shows every direction so well finds a creep by itself before it is worth a word.
constexpr double kFinely_m = 1e-3, kFinely_rad = 1e-3;
/// By how much (−2 log likelihood) the robot must speak for standing still before the background's word that
/// the sensor has moved is not believed, or for the move before it is believed at once.
constexpr double kDenial = 16;
constexpr double kOffsetMean_s = 1;
constexpr double kBias_s = 2;     // ... must have lasted
constexpr double kBiasOff = 0.7;  // share of the limit at which the verdict ends

Vector6d tolerance_of(const ShiftTestSettings& settings) {
  Vector6d tolerance;
  tolerance << Eigen::Vector3d::Constant(settings.tolerance_rad),
      Eigen::Vector3d::Constant(settings.tolerance_m);
  return tolerance;
}

}  // namespace

DriftWatch::DriftWatch(const VirtualCell& cell, const CameraModel& camera, const DriftSettings& settings)
    : settings_(settings),
      camera_(camera),
      robot_(cell, camera),
      tips_(cell.robot().tip_links()),
      map_(camera),
      matcher_(map_, tolerance_of(settings.shift)),
      scene_(settings.scene, map_.grid().width),
      test_(settings.shift) {
  report_.threshold = test_.threshold();
}

void DriftWatch::set_pose(const Pose& T_base_sensor) {
  T_base_sensor_ = T_base_sensor;
  set_background(BackgroundMap(camera_));
}

void DriftWatch::learn(std::span<const View> views) {
  if (moved_) return;  // it was learnt from elsewhere
  auto background = learn_background(robot_, camera_, views, T_base_sensor_);
  if (!background.is_empty()) set_background(std::move(background));
}

void DriftWatch::set_background(BackgroundMap background) {
  map_ = std::move(background);
  start_over();
}

void DriftWatch::start_over() {
  matcher_.start_over();
  scene_.reset();
  test_.reset();
  word_.reset();
  dispute_.reset();
  T_learnt_now_.reset();
  robot_word_.reset();
  moved_ = bias_changed_ = model_wrong_ = is_refined_ = lies_elsewhere_ = false;
  quiet_frames_ = found_frames_ = 0;
  lost_since_s_ = offset_over_s_ = learnt_s_ = alarmed_since_s_ = -1;
  evidence_s_ = risen_s_ = in_front_s_ = denied_s_ = denied_since_s_ = -1e9;
  offset_m_ = 0;
  followed_.setZero();
  absorbed_s_ = frame_s_;
  report_ = {};
  report_.threshold = test_.threshold();
}

const DriftReport& DriftWatch::add_frame(const View& frame) {
  if (frame.stamp_s - frame_s_ > kGap_s) on_gap();
  frame_s_ = frame.stamp_s;
  if (learnt_s_ < 0) learnt_s_ = frame_s_;
  ++frames_;
  report_.has_background = has_background();
  innovation_.reset();
  if (has_background()) {
    std::span<const std::uint8_t> robot;
    if (!frame.joint_positions_rad.empty()) robot = robot_.at(frame.joint_positions_rad, T_base_sensor_);
    auto observation = matcher_.match(frame.depth, robot, T_base_sensor_.linear());
    if (!observation.has_evidence && frames_ % kRealignEvery == 0) realign(robot, observation);
    if (observation.has_evidence) evidence_s_ = frame_s_;
    if (observation.has_evidence && !observation.realigned) lies_elsewhere_ = false;
    const bool had_moved = moved_;
    follow_loss(observation, frame_s_);
    test(observation);
    const bool is_far = moved_ && !observation.realigned && observation.share(CellState::same) < kLeastSame;
    if (is_far && (!had_moved || frames_ % kRealignEvery == 0)) realign(robot, observation);
    follow_offset(observation, frame_s_);
    describe(observation);
    refine(observation, frame_s_);
    if (!frame.joint_positions_rad.empty()) {  // else what seems to stand in front may be the robot
      mark_carried();
      scene_.add(matcher_.states(), matcher_.depth_m(), carried_, frame_s_);
      if (scene_.is_something_in_front()) in_front_s_ = frame_s_;
      absorb_what_moved_as_one(frame_s_);
      absorb(frame_s_);
    }
  }
  judge(frame_s_);
  return report_;
}

void DriftWatch::test(const BackgroundObservation& observation) {
  if (!observation.has_evidence) return on_gap();
  const Matrix6d move = shift_of_point(T_base_sensor_.linear() * map_.middle_sensor());
  innovation_ =
      Innovation{move * observation.shift, move * observation.covariance * move.transpose(),
                 move * observation.supported_shift,
                 move * observation.supported_covariance * move.transpose(), observation.common_share};
  test_.add(innovation_->supported_shift, innovation_->supported_covariance, innovation_->common_share);
  follow_rise();
  const auto& supported = innovation_->supported_covariance;
  const bool is_pinned = pins(supported, settings_.pinned_m, settings_.pinned_rad);
  word_.add(is_pinned, pins(supported, kFinely_m, kFinely_rad), frame_s_);
  const bool is_disputed =
      !is_pinned && pins(innovation_->covariance, settings_.pinned_m, settings_.pinned_rad);
  if (is_disputed && observation.unsupported)
    dispute_.add(*observation.unsupported, innovation_->turn_shift, frame_s_);
  else
    dispute_.add_none(innovation_->turn_shift, frame_s_);
  count_quiet();
  last_covariance_ = innovation_->covariance;
  report_.turn_sigma_rad = std::sqrt(innovation_->covariance.topLeftCorner<3, 3>().trace());
  report_.shift_sigma_m = std::sqrt(innovation_->covariance.bottomRightCorner<3, 3>().trace());
  raise_alarm();
}

/// A shift that shows in some frames and not in others rises several times.
void DriftWatch::follow_rise() {
  if (test_.run_length() == 0) return;
  if (frame_s_ - risen_s_ > kEvidence_s) {
    rises_since_s_ = frame_s_;
    was_open_ = !word_.pins_within(kEvidence_s, frame_s_);
  }
  risen_s_ = frame_s_;
}

void DriftWatch::on_gap() {
  quiet_frames_ = 0;
  word_.on_gap();
}

/// What the background shows in a direction that it left open until just now may be a large thing that was
/// pushed along it: the robot is heard first, if it has something to say.
void DriftWatch::raise_alarm() {
  if (!test_.is_alarmed() || moved_) {
    alarmed_since_s_ = -1;
    return;
  }
  if (alarmed_since_s_ < 0) alarmed_since_s_ = frame_s_;
  const double preference = robots_preference(frame_s_);
  if (preference > kDenial) return on_denial();
  if (preference > -kDenial && was_open_ && frame_s_ - alarmed_since_s_ < kAnswer_s) return;
  moved_ = true;
}

/// What one frame shows of every direction is enough to say that the sensor stands. What the test tolerates,
/// because all frames have it in common, is not known either.
bool DriftWatch::pins(const Matrix6d& covariance, double within_m, double within_rad) const {
  const double tolerated = 1 + ShiftTest::kCommonSigmas * std::sqrt(innovation_->common_share);
  return tolerated * worst_sigma(covariance.topLeftCorner<3, 3>()) < within_rad &&
         tolerated * worst_sigma(covariance.bottomRightCorner<3, 3>()) < within_m;
}

/// Frames on end that show the background where it was. The sequential test needs some frames to find a move,
/// and must not be taken for quiet before.
void DriftWatch::count_quiet() {
  const double sigma_rad = std::sqrt(innovation_->covariance.topLeftCorner<3, 3>().trace());
  const double sigma_m = std::sqrt(innovation_->covariance.bottomRightCorner<3, 3>().trace());
  const bool is_quiet =
      innovation_->turn_shift.head<3>().norm() < settings_.shift.tolerance_rad + 3 * sigma_rad &&
      innovation_->turn_shift.tail<3>().norm() < settings_.shift.tolerance_m + 3 * sigma_m;
  quiet_frames_ = is_quiet ? quiet_frames_ + 1 : 0;
}

/// What stands around has moved as one; the robot says that the sensor has not.
void DriftWatch::on_denial() {
  if (frame_s_ - denied_s_ > kEvidence_s) {
    denied_since_s_ = frame_s_;
    scene_.forget_means();
  }
  denied_s_ = frame_s_;
  test_.reset();
}

void DriftWatch::follow_offset(const BackgroundObservation& observation, double now_s) {
  if (!observation.has_evidence || observation.realigned) return;
  const double newest = 1 / (kOffsetMean_s * settings_.shift.rate_hz);
  offset_m_ += newest * (observation.known_offset_m() - offset_m_);
  offset_sigma_m_ = observation.offset_sigma_m * std::sqrt(newest);
  const double over = std::abs(offset_m_) - 3 * offset_sigma_m_;
  if (over < kBiasOff * settings_.depth_bias_m) bias_changed_ = false;
  if (over < settings_.depth_bias_m) {
    offset_over_s_ = -1;
    return;
  }
  if (offset_over_s_ < 0) offset_over_s_ = now_s;
  bias_changed_ = bias_changed_ || now_s - offset_over_s_ >= kBias_s;
}

/// Nothing of the background is where any nearby place of the sensor would see it, and that is not because
/// something stands in front: much lies farther, or the robot is elsewhere, too, or all that is seen is
/// the background from elsewhere.
void DriftWatch::follow_loss(const BackgroundObservation& observation, double now_s) {
  const bool elsewhere = lies_elsewhere_ || observation.share(CellState::farther) >= kLeastGone ||
                         (observation.share(CellState::same) < kLeastLeft && robot_word_.is_off(frame_s_));
  const bool lost = !observation.has_evidence && elsewhere;
  const bool is_where_it_was = observation.has_evidence && !observation.realigned;
  found_frames_ = is_where_it_was ? found_frames_ + 1 : 0;
  if (found_frames_ >= kFoundAgain || observation.share(CellState::dark) > kDarkShare) lost_since_s_ = -1;
  if (!lost) return;
  if (lost_since_s_ < 0 || now_s - lost_s_ > kGap_s) lost_since_s_ = now_s;
  lost_s_ = now_s;
  if (now_s - lost_since_s_ < (lies_elsewhere_ ? kElsewhere_s : kLost_s)) return;
  if (!robot_word_.agrees_since(lost_since_s_, frame_s_))
    moved_ = true;
  else
    on_denial();
}

void DriftWatch::describe(const BackgroundObservation& observation) {
  report_.statistic = test_.statistic();
  const Vector6d mean = test_.mean();
  report_.turn_rad = mean.head<3>().norm();
  report_.shift_m = mean.tail<3>().norm();
  report_.depth_offset_change_m = offset_m_;
  report_.same = observation.share(CellState::same);
  report_.nearer = observation.share(CellState::nearer);
  report_.farther = observation.share(CellState::farther);
  report_.dark = observation.share(CellState::dark);
  if (moved_ && frame_s_ - evidence_s_ > kEvidence_s) report_.T_base_sensor_seen.reset();
  const bool is_known = report_.shift_sigma_m < kSeenWithin_m && report_.turn_sigma_rad < kSeenWithin_rad;
  const bool is_fit = observation.realigned || report_.same >= kLeastSame;
  if (!moved_ || !observation.has_evidence || !is_known || !is_fit) return;
  report_.T_base_sensor_seen =
      observation.realigned ? T_base_sensor_ * *T_learnt_now_ : perturbed(T_base_sensor_, observation.shift);
  report_.seen_turn_sigma_rad = report_.turn_sigma_rad;
  report_.seen_shift_sigma_m = report_.shift_sigma_m;
}

}  // namespace calibrd
