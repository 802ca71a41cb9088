// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/drift_watch.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/drift/background_align.hpp"

namespace calibrd {
namespace {

constexpr double kEvidence_s = 1;   // without any for so long: no_evidence
constexpr double kLost_s = 1;       // a background that is nowhere for so long: the sensor looks elsewhere
constexpr double kLeastGone = 0.2;  // share of it that lies farther: nobody who stands in front does that
constexpr int kRealignEvery = 3;    // frames; it takes some milliseconds
constexpr double kInFront_s = 0.5;  // a verdict outlives what it speaks of by so long
constexpr double kOffsetMean_s = 1;
constexpr double kBias_s = 2;     // ... must have lasted
constexpr double kBiasOff = 0.7;  // share of the limit at which the verdict ends
constexpr double kCheck_s = 2;    // a comparison with the robot is of now for so long
/// CUSUM of how far off the robot looks: a comparison of a good model stays below 2.2 standard deviations of
/// what noise, model and joint zeros explain, in every posture; the allowance is beyond that, because the
/// comparisons of one posture all err alike.
constexpr double kRobotAllowance = 2.7, kRobotMost = 2, kRobotLimit = 6;
constexpr double kUnexplained = 6;  // standard deviations, where so little agrees that none can be told
/// By how much (−2 log likelihood) the robot must speak for standing still before the background's word that
/// the sensor has moved is not believed.
constexpr double kDenial = 16;
constexpr double kAbsorbEvery_s = 5;

}  // namespace

DriftWatch::DriftWatch(const VirtualCell& cell, const CameraModel& camera, const DriftSettings& settings)
    : settings_(settings),
      camera_(camera),
      robot_(cell, camera),
      map_(camera),
      matcher_(map_),
      scene_(settings.scene, map_.grid().width),
      test_(settings.shift) {
  report_.threshold = test_.threshold();
}

void DriftWatch::set_pose(const Pose& T_base_sensor) {
  T_base_sensor_ = T_base_sensor;
  map_ = BackgroundMap(camera_);
  learn({});
}

void DriftWatch::learn(std::span<const View> views) {
  std::vector<std::vector<std::uint8_t>> masks;
  for (const View& view : views) masks.push_back(robot_.at(view.joint_positions_rad, T_base_sensor_));
  map_.learn(views, masks);
  start_over();
}

void DriftWatch::recall(std::span<const float> depth_m) {
  map_.recall(depth_m);
  start_over();
}

void DriftWatch::start_over() {
  matcher_.start_over();
  scene_.reset();
  test_.reset();
  T_learnt_now_.reset();
  check_.reset();
  moved_ = bias_changed_ = false;
  robot_statistic_ = 0;
  lost_since_s_ = offset_over_s_ = -1;
  evidence_s_ = in_front_s_ = check_s_ = -1e9;
  offset_m_ = 0;
  absorbed_s_ = frame_s_;
  report_ = {};
  report_.threshold = test_.threshold();
}

const DriftReport& DriftWatch::add_frame(const View& frame) {
  frame_s_ = frame.stamp_s;
  ++frames_;
  report_.has_background = has_background();
  innovation_.reset();
  if (has_background()) {
    std::span<const std::uint8_t> robot;
    if (!frame.joint_positions_rad.empty()) robot = robot_.at(frame.joint_positions_rad, T_base_sensor_);
    auto observation = matcher_.match(frame.depth, robot, T_base_sensor_.linear());
    if (!observation.has_evidence && frames_ % kRealignEvery == 0) realign(robot, observation);
    if (observation.has_evidence) evidence_s_ = frame_s_;
    follow_loss(observation, frame_s_);
    test(observation);
    follow_offset(observation, frame_s_);
    mark_carried(frame);
    scene_.add(matcher_.states(), matcher_.depth_m(), carried_, frame_s_);
    if (scene_.is_something_in_front()) in_front_s_ = frame_s_;
    describe(observation);
    absorb(frame, frame_s_);
  }
  judge(frame_s_);
  return report_;
}

/// The background is not where it was, pixel by pixel: perhaps the sensor sees it from elsewhere.
void DriftWatch::realign(std::span<const std::uint8_t> robot, BackgroundObservation& observation) {
  if (observation.share(CellState::dark) > 0.8) return;
  std::optional<BackgroundAlignment> found;
  if (T_learnt_now_) found = align_background(map_, matcher_.depth_m(), {}, *T_learnt_now_);
  if (!found) found = align_background(map_, matcher_.depth_m(), robot, Pose::Identity());
  if (!found) return T_learnt_now_.reset();
  T_learnt_now_ = found->T_learnt_now;
  const Eigen::Matrix3d R = T_base_sensor_.linear();
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  observation.has_evidence = observation.realigned = true;
  observation.shift = difference(T_base_sensor_, T_base_sensor_ * found->T_learnt_now);
  observation.covariance = turn * found->covariance * turn.transpose();
}

void DriftWatch::test(const BackgroundObservation& observation) {
  if (!observation.has_evidence) return;
  const Matrix6d move = shift_of_point(T_base_sensor_.linear() * map_.middle_sensor());
  innovation_ = Innovation{move * observation.shift, move * observation.covariance * move.transpose()};
  test_.add(innovation_->turn_shift, innovation_->covariance);
  report_.turn_sigma_rad = std::sqrt(innovation_->covariance.topLeftCorner<3, 3>().trace());
  report_.shift_sigma_m = std::sqrt(innovation_->covariance.bottomRightCorner<3, 3>().trace());
  if (!test_.is_alarmed() || moved_) return;
  if (robot_denies_the_shift(frame_s_)) {
    // What stands around has moved as one; the robot says that the sensor has not.
    report_.verdict = DriftVerdict::scene_changed;
    in_front_s_ = frame_s_;
    test_.reset();
    return;
  }
  moved_ = true;
}

/// For each hypothesis how badly the robot's apparent shift fits it.
bool DriftWatch::robot_denies_the_shift(double now_s) const {
  const double age = now_s - check_s_, onset = test_.run_length() / settings_.shift.rate_hz;
  if (!check_ || !check_->enough_evidence || !check_->agrees || age > std::min(kCheck_s, onset)) return false;
  const Matrix6d move = shift_of_point(check_->middle_base - T_base_sensor_.translation());
  const Matrix6d back = shift_of_point(-(T_base_sensor_.linear() * map_.middle_sensor()));
  const Vector6d moved = move * (back * test_.mean()), seen = check_->turn_shift;
  const Eigen::LDLT<Matrix6d> solver(check_->turn_shift_covariance);
  const double stands = seen.dot(solver.solve(seen));
  const Vector6d off = seen - moved;
  return stands + kDenial < off.dot(solver.solve(off));
}

void DriftWatch::follow_offset(const BackgroundObservation& observation, double now_s) {
  if (!observation.has_evidence || observation.realigned) return;
  const double newest = 1 / (kOffsetMean_s * settings_.shift.rate_hz);
  offset_m_ += newest * (observation.offset_change_m - offset_m_);
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

/// Nothing of the background is where any nearby place of the sensor would see it.
void DriftWatch::follow_loss(const BackgroundObservation& observation, double now_s) {
  const bool lost = !observation.has_evidence && observation.share(CellState::farther) >= kLeastGone;
  if (observation.has_evidence || observation.share(CellState::dark) > 0.5) lost_since_s_ = -1;
  if (!lost) return;
  if (lost_since_s_ < 0) lost_since_s_ = now_s;
  if (now_s - lost_since_s_ >= kLost_s) moved_ = true;
}

/// What the robot carries moves with the end of its arm.
void DriftWatch::mark_carried(const View& frame) {
  carried_.assign(map_.cells().size(), 0);
  if (frame.joint_positions_rad.empty()) return;
  const auto& model = robot_.cell().robot();
  std::vector<bool> ends(model.links().size(), true);
  for (const Joint& joint : model.joints()) ends[static_cast<std::size_t>(joint.parent_link)] = false;
  std::vector<Eigen::Vector3d> tips_sensor;
  for (std::size_t l = 0; l < ends.size(); ++l)
    if (ends[l] && model.links()[l].parent_joint >= 0)
      tips_sensor.push_back(T_base_sensor_.inverse() * robot_.cell().link_poses()[l].translation());
  const double reach = settings_.carried_reach_m * settings_.carried_reach_m;
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    if (matcher_.states()[i] != CellState::nearer) continue;
    const auto width = static_cast<std::size_t>(map_.grid().width);
    const Eigen::Vector3d p = static_cast<double>(matcher_.depth_m()[i]) *
                              map_.rays().at(static_cast<int>(i % width), static_cast<int>(i / width));
    for (const auto& tip : tips_sensor)
      if ((p - tip).squaredNorm() < reach) carried_[i] = 1;
  }
}

/// What stands for long is background; the plain one is left as it was, or a sensor that creeps would take it
/// along.
void DriftWatch::absorb(const View& frame, double now_s) {
  if (now_s - absorbed_s_ < kAbsorbEvery_s) return;
  absorbed_s_ = now_s;
  if (moved_ || wants_check()) return;
  const auto chosen = scene_.unchanged_for(settings_.absorb_s);
  if (std::ranges::count(chosen, std::uint8_t{1}) == 0) return;
  map_.relearn(frame.depth, chosen);
  matcher_.refresh();
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
  if (!moved_ || !observation.has_evidence) return;
  report_.T_base_sensor_seen =
      observation.realigned ? T_base_sensor_ * *T_learnt_now_ : perturbed(T_base_sensor_, observation.shift);
}

void DriftWatch::add_check(const PoseCheck& check, double now_s) {
  if (!check.enough_evidence) return;
  check_ = check;
  check_s_ = now_s;
  const double sigmas = check.agrees || check.shift_sigmas > 0 ? check.shift_sigmas : kUnexplained;
  robot_statistic_ = std::max(0.0, robot_statistic_ + std::min(sigmas - kRobotAllowance, kRobotMost));
  robot_statistic_ = std::min(robot_statistic_, 2 * kRobotLimit);  // what is mended shows soon
}

bool DriftWatch::is_in_place() const {
  return has_background() && !moved_ && frame_s_ - evidence_s_ < kEvidence_s && !wants_check();
}

void DriftWatch::judge(double now_s) {
  const bool seen = now_s - evidence_s_ < kEvidence_s || now_s - check_s_ < kCheck_s;
  const bool in_front = now_s - in_front_s_ < kInFront_s;
  if (moved_)
    report_.verdict = DriftVerdict::sensor_moved;
  else if (robot_statistic_ > kRobotLimit && is_in_place())
    report_.verdict = DriftVerdict::robot_model_wrong;
  else if (bias_changed_)
    report_.verdict = DriftVerdict::depth_bias_changed;
  else if (scene_.has_changed())
    report_.verdict = DriftVerdict::scene_changed;
  else if (in_front)
    report_.verdict = DriftVerdict::something_in_front;
  else
    report_.verdict = seen ? DriftVerdict::in_place : DriftVerdict::no_evidence;
}

const char* name_of(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::in_place:
      return "in_place";
    case DriftVerdict::sensor_moved:
      return "sensor_moved";
    case DriftVerdict::something_in_front:
      return "something_in_front";
    case DriftVerdict::scene_changed:
      return "scene_changed";
    case DriftVerdict::robot_model_wrong:
      return "robot_model_wrong";
    case DriftVerdict::depth_bias_changed:
      return "depth_bias_changed";
    case DriftVerdict::no_evidence:
      break;
  }
  return "no_evidence";
}

const char* text_of(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::in_place:
      return "the sensor sees the cell as when it was calibrated";
    case DriftVerdict::sensor_moved:
      return "the sensor has moved: its pose is wrong until it is calibrated again";
    case DriftVerdict::something_in_front:
      return "something passes between the sensor and what it knows";
    case DriftVerdict::scene_changed:
      return "something in the cell was moved, brought or taken away; the sensor stands";
    case DriftVerdict::robot_model_wrong:
      return "the sensor stands, but the robot is not where its joints say: check joint zeros, the tool, the "
             "robot's "
             "base and the model";
    case DriftVerdict::depth_bias_changed:
      return "the sensor stands, but its range reads otherwise than when it was calibrated, as while it "
             "warms up; "
             "calibrate again once it is warm if depths are used as they come";
    case DriftVerdict::no_evidence:
      break;
  }
  return "nothing is in view that could tell: neither robot nor known background, or the sensor is dark";
}

}  // namespace calibrd
