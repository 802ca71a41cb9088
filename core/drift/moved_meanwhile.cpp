// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/moved_meanwhile.hpp"

#include <Eigen/Cholesky>
#include <vector>

#include "core/drift/window_support.hpp"

namespace calibrd {
namespace {

constexpr double kTolerated_m = 1e-3, kTolerated_rad = 1e-3;
/// The noise of two frames, one of them remembered.
constexpr double kTwoFrames = 2;
constexpr double kToleratedShare = 0.5;  // as squares_beyond_tolerance()
/// In squares; calibrations of a sensor that stood, joint zeros off among them, stay below 6
/// (docs/figures.md).
constexpr double kMostBackground = 9, kMostRobot = 9;

/// The views up to one, as one shift of the base's origin.
struct Shifts {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  Eigen::Vector3d middle_sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;

  void add(const PoseCheck& check) {
    const Matrix6d move = shift_of_point(-check.middle_base);
    const Matrix6d known =
        (move * check.turn_shift_covariance * move.transpose()).ldlt().solve(Matrix6d::Identity());
    information += known;
    pull += known * (move * check.turn_shift);
    middle_sum += check.middle_base;
    ++count;
  }
};

Vector6d tolerance() {
  Vector6d tolerance;
  tolerance << Eigen::Vector3d::Constant(kTolerated_rad), Eigen::Vector3d::Constant(kTolerated_m);
  return tolerance;
}

/// What a shift is known to, once what is tolerated of a background is taken for noise of it.
Matrix6d tolerated(const Matrix6d& covariance) {
  Matrix6d sum = kTwoFrames * covariance;
  sum.diagonal() += (kToleratedShare * tolerance()).cwiseAbs2();
  return sum;
}

/// What the robot shows after less what it shows before, of its middle, and what the background does of the
/// same move: a camera that is described wrongly, or a wrong model, has the robot off by something else in
/// every posture, but a background stands.
SplitOfViews compare(const Shifts& all, const Shifts& before, const Pose& T_base_sensor,
                     const std::optional<BackgroundObservation>& seen) {
  const Matrix6d after = all.information - before.information;
  const Eigen::LDLT<Matrix6d> of_before(before.information), of_after(after);
  const Eigen::Vector3d middle_base = all.middle_sum / static_cast<double>(all.count);
  const Matrix6d move = shift_of_point(middle_base);
  const Vector6d shift = move * (of_after.solve(all.pull - before.pull) - of_before.solve(before.pull));
  const Matrix6d covariance = of_after.solve(Matrix6d::Identity()) + of_before.solve(Matrix6d::Identity());
  Matrix6d information = (move * covariance * move.transpose()).ldlt().solve(Matrix6d::Identity());
  Vector6d pull = information * shift;
  if (seen) {
    const Matrix6d there = shift_of_point(middle_base - T_base_sensor.translation());
    const Matrix6d known =
        tolerated(there * seen->supported_covariance * there.transpose()).ldlt().solve(Matrix6d::Identity());
    information += known;
    pull += known * (there * seen->supported_shift);
  }
  const Vector6d together = information.ldlt().solve(pull);
  return {0, pull.dot(together), together};
}

}  // namespace

ViewsInOrder::ViewsInOrder(const VirtualCell& cell, const CameraModel& camera)
    : camera_(camera), robot_(cell, camera), checker_(cell, camera) {}

std::optional<BackgroundObservation> ViewsInOrder::match(const View& remembered, const View& now,
                                                         const Pose& T_base_sensor) {
  const auto map = learn_background(robot_, camera_, {&remembered, 1}, T_base_sensor);
  if (map.is_empty()) return std::nullopt;
  BackgroundMatcher matcher(map, tolerance());
  const auto& mask = robot_.at(now.joint_positions_rad, T_base_sensor);
  const auto seen = matcher.match(now.depth, mask, T_base_sensor.linear());
  middle_sensor_ = map.middle_sensor();
  return seen.has_evidence ? std::optional(seen) : std::nullopt;
}

SplitOfViews ViewsInOrder::background_split(std::span<const View> views, const Pose& T_base_sensor) {
  SplitOfViews largest;
  const auto compare_with = [&](std::size_t remembered, std::size_t now) {
    const auto seen = match(views[remembered], views[now], T_base_sensor);
    if (!seen) return;
    const Matrix6d move = shift_of_point(T_base_sensor.linear() * middle_sensor_);
    const Matrix6d scaled = tolerance().cwiseInverse().asDiagonal() * move;
    const Matrix6d covariance = kTwoFrames * scaled * seen->supported_covariance * scaled.transpose();
    const double squares = squares_beyond_tolerance(scaled * seen->supported_shift, covariance);
    if (squares > largest.squares) largest = {now - 1, squares, move * seen->supported_shift};
  };
  for (std::size_t i = 1; i < views.size(); ++i) {
    compare_with(i - 1, i);
    if (i > 1) compare_with(0, i);
  }
  return largest;
}

SplitOfViews ViewsInOrder::robot_split(std::span<const View> views, const Pose& T_base_sensor,
                                       const DepthCorrection& correction) {
  std::vector<PoseCheck> checks;
  std::vector<std::size_t> of_views;
  Shifts all, before;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto check = checker_.check(views[i], T_base_sensor, correction);
    if (!check.enough_evidence || !(check.shift_sigmas > 0)) continue;
    all.add(check);
    checks.push_back(check);
    of_views.push_back(i);
  }
  SplitOfViews largest;
  for (std::size_t i = 0; i + 1 < checks.size(); ++i) {
    before.add(checks[i]);
    const auto seen = match(views[of_views[i]], views[of_views[i + 1]], T_base_sensor);
    SplitOfViews split = compare(all, before, T_base_sensor, seen);
    split.before = of_views[i];
    if (split.squares > largest.squares) largest = split;
  }
  return largest;
}

std::optional<MovedMeanwhile> ViewsInOrder::find_move(std::span<const View> views, const Pose& T_base_sensor,
                                                      const DepthCorrection& correction) {
  const auto as_move = [](MovedMeanwhile::Witness witness, const SplitOfViews& split) {
    return MovedMeanwhile{witness, split.before, split.turn_shift.tail<3>().norm(),
                          split.turn_shift.head<3>().norm()};
  };
  if (const auto split = background_split(views, T_base_sensor); split.squares > kMostBackground)
    return as_move(MovedMeanwhile::Witness::background, split);
  if (const auto split = robot_split(views, T_base_sensor, correction); split.squares > kMostRobot)
    return as_move(MovedMeanwhile::Witness::robot, split);
  return std::nullopt;
}

}  // namespace calibrd
