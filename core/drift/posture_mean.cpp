// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/posture_mean.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace calibrd {
namespace {

constexpr std::size_t kLeastPostures = 5, kMostPostures = 20;
/// Of the joint that differs most: what is nearer is the same posture again.
constexpr double kDiffer_rad = 0.2;
/// A creep of 1 mm per hour moves the mean by half of it meanwhile.
constexpr double kOldest_s = 3600;
/// What postures of a region of the workspace have in common is not averaged out.
constexpr double kFloor_m = 3e-4, kFloor_rad = 3e-4;

}  // namespace

void PostureMean::add(const PoseCheck& check, std::span<const double> joints_rad, double now_s) {
  std::erase_if(ended_, [&](const Posture& other) { return now_s - other.left_s > kOldest_s; });
  if (!(check.shift_sigmas > 0)) return;
  const Vector6d about_origin = shift_of_point(-check.middle_base) * check.turn_shift;
  ++posture_.checks;
  posture_.turn_shift += (about_origin - posture_.turn_shift) / posture_.checks;
  posture_.joints_rad.assign(joints_rad.begin(), joints_rad.end());
  posture_.newest = check;
}

void PostureMean::end_posture(double now_s) {
  Posture ended = std::exchange(posture_, {});
  // One that disagrees is the business of RobotWord's CUSUM, and would linger here.
  if (ended.checks == 0 || !ended.newest.agrees) return;
  std::erase_if(ended_, [&](const Posture& other) {
    return std::ranges::equal(other.joints_rad, ended.joints_rad,
                              [](double a, double b) { return std::abs(a - b) < kDiffer_rad; });
  });
  ended.left_s = now_s;
  ended_.push_back(std::move(ended));
  if (ended_.size() > kMostPostures) ended_.pop_front();
}

std::optional<RobotShift> PostureMean::shift() const {
  if (ended_.size() < kLeastPostures) return std::nullopt;
  RobotShift shift;
  Matrix6d information = Matrix6d::Zero();  // about the base's origin, as the others
  Vector6d pull = Vector6d::Zero();
  for (const Posture& posture : ended_) {
    const Matrix6d move = shift_of_point(-posture.newest.middle_base);
    const Matrix6d own = posture.newest.turn_shift_covariance - posture.newest.pose_covariance;
    const Matrix6d known = (move * own * move.transpose()).ldlt().solve(Matrix6d::Identity());
    information += known;
    pull += known * posture.turn_shift;
    shift.middle_base += posture.newest.middle_base / static_cast<double>(ended_.size());
  }
  const PoseCheck& newest = ended_.back().newest;
  const Matrix6d from_newest = shift_of_point(shift.middle_base - newest.middle_base);
  const Matrix6d move = shift_of_point(shift.middle_base);
  const Eigen::LDLT<Matrix6d> solver(information);
  shift.turn_shift = move * solver.solve(pull);
  shift.covariance = move * solver.solve(Matrix6d::Identity()) * move.transpose() +
                     from_newest * newest.pose_covariance * from_newest.transpose();
  shift.covariance.diagonal().head<3>().array() += kFloor_rad * kFloor_rad;
  shift.covariance.diagonal().tail<3>().array() += kFloor_m * kFloor_m;
  shift.sigmas = std::sqrt(shift.turn_shift.dot(shift.covariance.ldlt().solve(shift.turn_shift)));
  return shift;
}

}  // namespace calibrd
