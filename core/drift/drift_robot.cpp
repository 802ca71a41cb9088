// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What DriftWatch makes of the robot's word.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/drift/drift_watch.hpp"

namespace calibrd {
namespace {

/// The sensor's own move may be what the robot shows when it leaves no more than this share of it (χ²)
/// unexplained.
constexpr double kUnexplainedShare = 0.4;
/// A background that shows every direction well now and then is the one to tell.
constexpr double kUnpinned_s = 30;
constexpr double kMostFollowed = 1.5;  // of what was followed, the robot may show: it lags, and is uncertain
constexpr double kMeanFrames = 7;      // that the mean of the test is of

/// Of those that tell by how much the robot is off.
std::vector<RobotShift> shifts_of(const std::vector<PoseCheck>& checks) {
  std::vector<RobotShift> shifts;
  for (const PoseCheck& check : checks)
    if (check.shift_sigmas > 0)
      shifts.push_back(
          {check.turn_shift, check.turn_shift_covariance, check.middle_base, check.shift_sigmas});
  return shifts;
}

}  // namespace

void DriftWatch::add_check(const PoseCheck& check, std::span<const double> joints_rad, double now_s) {
  robot_word_.add(check, joints_rad, now_s);
  if (dispute_.is_open() && check.enough_evidence) {
    const double preference = preference_of(check, dispute_.turn_shift());
    dispute_.hear(check.agrees ? preference : std::min(preference, 0.0), joints_rad, now_s);
  }
  if (robot_word_.is_against_no_more()) model_wrong_ = false;
  if (model_wrong_ || moved_) return;
  if (robot_word_.is_against()) {
    moved_ = is_robots_shift_possible(shifts_of(robot_word_.doubts()));
    model_wrong_ = !moved_;
  } else {
    moved_ = has_crept() || dispute_.is_affirmed();
  }
}

/// Along a direction that the background has hardly shown for long, or in which it was learnt anew, where
/// only the robot can tell. Elsewhere a shift so small is the model's.
bool DriftWatch::has_crept() const {
  const bool is_shown = has_background() && word_.pins_finely_within(kUnpinned_s, frame_s_);
  const auto creep = robot_word_.creep();
  if (!creep || (is_shown && !is_what_was_followed(*creep))) return false;
  return is_robots_shift_possible({&*creep, 1});
}

/// What the robot shows is, but for what is uncertain of it, some part of what the background has followed.
bool DriftWatch::is_what_was_followed(const RobotShift& robot) const {
  const Matrix6d move = shift_of_point(robot.middle_base - T_base_sensor_ * map_.middle_sensor());
  const Vector6d followed = move * followed_;
  const Eigen::LDLT<Matrix6d> solver(robot.covariance);
  const Vector6d weight = solver.solve(followed);
  const double squares = followed.dot(weight);
  if (!(squares > 0)) return false;
  const double share = std::clamp(robot.turn_shift.dot(weight) / squares, 0.0, kMostFollowed);
  const Vector6d left = robot.turn_shift - share * followed;
  return left.dot(solver.solve(left)) < kUnexplainedShare * std::pow(robot.sigmas, 2);
}

/// By how much (−2 log likelihood) the robot, seen since the test began to rise, speaks for standing still
/// rather than for the move that the background shows; 0: it has not been seen.
double DriftWatch::robots_preference(double now_s) const {
  const double run_s = test_.run_length() / settings_.shift.rate_hz;
  const double since_s =
      std::max(std::min(RobotWord::kOfNow_s, run_s), std::min(kAnswer_s, now_s - rises_since_s_));
  if (!robot_word_.has_spoken_within(since_s, now_s)) return 0;
  const PoseCheck& check = *robot_word_.newest();
  const double preference = preference_of(check, test_.mean());
  return check.agrees ? preference : std::min(preference, 0.0);
}

/// `turn_shift`: of the middle of the background.
double DriftWatch::preference_of(const PoseCheck& check, const Vector6d& turn_shift) const {
  const Matrix6d move = shift_of_point(check.middle_base - T_base_sensor_ * map_.middle_sensor());
  const Eigen::LDLT<Matrix6d> solver(check.turn_shift_covariance);
  const Vector6d seen = check.turn_shift, off = seen - move * turn_shift;
  return off.dot(solver.solve(off)) - seen.dot(solver.solve(seen));
}

/// The robot is not where it should be, and nothing else in view says that this is not the sensor's doing.
bool DriftWatch::is_robots_shift_possible(std::span<const RobotShift> postures) const {
  if (!has_background() || frame_s_ - evidence_s_ >= kEvidence_s || !last_covariance_) return true;
  if (postures.empty())
    return !word_.pins_within(kEvidence_s, frame_s_) || test_.statistic() > 0.5 * test_.threshold();
  return is_one_move(postures);
}

/// One move of the sensor that the background leaves possible explains what all postures show. Of one posture
/// a slide along a wall explains nearly everything; of several not what turns with a joint.
bool DriftWatch::is_one_move(std::span<const RobotShift> postures) const {
  Matrix6d before = *last_covariance_ / kMeanFrames;
  before.diagonal().head<3>().array() += std::pow(settings_.shift.tolerance_rad, 2);
  before.diagonal().tail<3>().array() += std::pow(settings_.shift.tolerance_m, 2);
  before += followed_ * followed_.transpose();
  Matrix6d information = before.ldlt().solve(Matrix6d::Identity());
  Vector6d pull = Vector6d::Zero();  // of the move beyond what the background shows itself
  double left = 0, shown = 0;        // χ²
  for (const RobotShift& robot : postures) {
    const Matrix6d move = shift_of_point(robot.middle_base - T_base_sensor_ * map_.middle_sensor());
    const Vector6d off = robot.turn_shift - move * test_.mean();
    const Eigen::LDLT<Matrix6d> solver(robot.covariance);
    information += move.transpose() * solver.solve(move);
    pull += move.transpose() * solver.solve(off);
    left += off.dot(solver.solve(off));
    shown += std::pow(robot.sigmas, 2);
  }
  left -= pull.dot(information.ldlt().solve(pull));
  return left < kUnexplainedShare * shown;
}

}  // namespace calibrd
