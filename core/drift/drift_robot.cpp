// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What DriftWatch makes of the robot's word.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/drift/drift_watch.hpp"

namespace calibrd {
namespace {

constexpr double kOff_s = 0.5;  // one comparison alone says nothing of a second
constexpr double kCheck_s = 2;  // a comparison with the robot is of now for so long
/// CUSUM of how far off the robot looks, posture by posture: a comparison of a good model stays below 2.2
/// standard deviations of what noise, model and joint zeros explain, in nearly every posture.
constexpr double kRobotAllowance = 2.7, kPostureWeight = 2, kRobotLimit = 5.5;
constexpr double kMostPerPosture = 4, kOtherPosture_rad = 0.05;
constexpr double kUnexplained = 6;  // standard deviations, where so little agrees that none can be told
/// By how much (−2 log likelihood) the robot must speak for standing still before the background's word that
/// the sensor has moved is not believed.
constexpr double kDenial = 16;
/// The sensor's own move may be what the robot shows when it leaves no more than this share of it (χ²)
/// unexplained.
constexpr double kUnexplainedShare = 0.4;
constexpr double kMeanFrames = 7;  // that the mean of the test is of

}  // namespace

void DriftWatch::add_check(const PoseCheck& check, double now_s) {
  if (!check.enough_evidence) return;
  check_ = check;
  check_s_ = now_s;
  follow_posture(check.agrees || check.shift_sigmas > 0 ? check.shift_sigmas : kUnexplained);
  if (robot_statistic_ < 0.5 * kRobotLimit) model_wrong_ = false;
  if (robot_statistic_ <= kRobotLimit || model_wrong_ || moved_) return;
  if (is_robots_shift_possible())
    moved_ = true;
  else
    model_wrong_ = true;
}

/// Comparisons of one posture all err alike, and a part in the gripper may look like the robot: a posture has
/// one word, and one posture alone says nothing against the robot.
void DriftWatch::follow_posture(double sigmas) {
  bool same = posture_.size() == joints_.size();
  for (std::size_t j = 0; same && j < joints_.size(); ++j)
    same = std::abs(joints_[j] - posture_[j]) < kOtherPosture_rad;
  if (!same) {
    posture_ = joints_;
    before_posture_ = std::min(robot_statistic_, kRobotLimit);  // what is mended shows soon
    posture_sigmas_ = posture_checks_ = 0;
  }
  ++posture_checks_;
  posture_sigmas_ += (sigmas - posture_sigmas_) / posture_checks_;
  const double word =
      std::clamp(kPostureWeight * (posture_sigmas_ - kRobotAllowance), -kMostPerPosture, kMostPerPosture);
  robot_statistic_ = std::max(0.0, before_posture_ + word);
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

bool DriftWatch::robot_stands_since(double since_s) const {
  return check_ && check_->agrees && check_s_ > since_s && frame_s_ - check_s_ < kCheck_s;
}

bool DriftWatch::is_robot_off() const { return check_ && !check_->agrees && frame_s_ - check_s_ < kOff_s; }

/// The robot is not where it should be, and nothing else in view says that this is not the sensor's doing.
bool DriftWatch::is_robots_shift_possible() const {
  if (!has_background() || frame_s_ - evidence_s_ >= kEvidence_s || !last_covariance_) return true;
  if (!(check_->shift_sigmas > 0))
    return frame_s_ - pinned_s_ >= kEvidence_s || test_.statistic() > 0.5 * test_.threshold();
  const Matrix6d move = shift_of_point(check_->middle_base - T_base_sensor_.translation()) *
                        shift_of_point(-(T_base_sensor_.linear() * map_.middle_sensor()));
  const Vector6d left = check_->turn_shift - move * test_.mean();
  Matrix6d mean_covariance = *last_covariance_ / kMeanFrames;
  mean_covariance.diagonal().head<3>().array() += std::pow(settings_.shift.tolerance_rad, 2);
  mean_covariance.diagonal().tail<3>().array() += std::pow(settings_.shift.tolerance_m, 2);
  const Matrix6d covariance = check_->turn_shift_covariance + move * mean_covariance * move.transpose();
  return left.dot(covariance.ldlt().solve(left)) < kUnexplainedShare * std::pow(check_->shift_sigmas, 2);
}

}  // namespace calibrd
