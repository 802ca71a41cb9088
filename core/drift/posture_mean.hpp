// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/check_pose.hpp"

namespace calibrd {

/// How far off the robot looks, if it is the sensor that has moved: see PoseCheck.
struct RobotShift {
  Vector6d turn_shift = Vector6d::Zero();  ///< rad and m, base axes, of the point `middle_base`
  Matrix6d covariance = Matrix6d::Identity();
  Eigen::Vector3d middle_base = Eigen::Vector3d::Zero();  ///< m
  double sigmas = 0;
};

/// How far off the robot looks, as one shift of the sensor that all of the last postures share: what joint
/// zeros and model make of one posture averages out over many, so that less shows than in one. Only
/// postures that differ count, each once and by what it tells of each direction: of a robot that goes to and
/// fro between a few, what the model makes of them stays. What is older than an hour says nothing of now.
/// Without I/O.
class PostureMean {
 public:
  /// A comparison of the posture that the robot stands in.
  void add(const PoseCheck& check, std::span<const double> joints_rad, double now_s);
  /// The robot has left it.
  void end_posture(double now_s);

  /// Nothing: it is of too few postures.
  std::optional<RobotShift> shift() const;

 private:
  struct Posture {
    PoseCheck newest;
    Vector6d turn_shift = Vector6d::Zero();  // mean of its comparisons, about the base's origin
    std::vector<double> joints_rad;
    int checks = 0;
    double left_s = 0;
  } posture_;
  std::deque<Posture> ended_;  // oldest first
};

}  // namespace calibrd
