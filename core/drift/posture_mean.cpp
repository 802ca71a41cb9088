// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/posture_mean.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kForget = 0.1;  // of what is known, with each posture
constexpr int kLeastPostures = 12;
/// What postures of a region of the workspace have in common is not averaged out.
constexpr double kFloor_m = 3e-4, kFloor_rad = 3e-4;

}  // namespace

void PostureMean::add(const PoseCheck& check) {
  if (!(check.shift_sigmas > 0)) return;
  const Vector6d about_origin = shift_of_point(-check.middle_base) * check.turn_shift;
  ++posture_.checks;
  posture_.turn_shift += (about_origin - posture_.turn_shift) / posture_.checks;
  posture_.newest = check;
}

void PostureMean::end_posture() {
  const Posture ended = posture_;
  posture_ = {};
  // One that disagrees is the business of RobotWord's CUSUM, and would linger here.
  if (ended.checks == 0 || !ended.newest.agrees) return;
  const Matrix6d move = shift_of_point(-ended.newest.middle_base);
  pose_covariance_ = move * ended.newest.pose_covariance * move.transpose();
  const Matrix6d own =
      move * (ended.newest.turn_shift_covariance - ended.newest.pose_covariance) * move.transpose();
  const Matrix6d information = own.ldlt().solve(Matrix6d::Identity());
  information_ = (1 - kForget) * information_ + information;
  pull_ = (1 - kForget) * pull_ + information * ended.turn_shift;
  const double newest = postures_ == 0 ? 1 : kForget;
  middle_base_ += newest * (ended.newest.middle_base - middle_base_);
  ++postures_;
}

std::optional<RobotShift> PostureMean::shift() const {
  if (postures_ < kLeastPostures) return std::nullopt;
  RobotShift shift;
  shift.middle_base = middle_base_;
  const Eigen::LDLT<Matrix6d> solver(information_);
  const Matrix6d move = shift_of_point(middle_base_);
  shift.turn_shift = move * solver.solve(pull_);
  shift.covariance = move * (solver.solve(Matrix6d::Identity()) + pose_covariance_) * move.transpose();
  shift.covariance.diagonal().head<3>().array() += kFloor_rad * kFloor_rad;
  shift.covariance.diagonal().tail<3>().array() += kFloor_m * kFloor_m;
  shift.sigmas = std::sqrt(shift.turn_shift.dot(shift.covariance.ldlt().solve(shift.turn_shift)));
  return shift;
}

}  // namespace calibrd
