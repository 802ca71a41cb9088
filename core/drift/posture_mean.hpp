// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

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
/// zeros and model make of one posture averages out over many, so that less shows than in one. Postures count
/// by what they tell of each direction, older ones ever less. Without I/O.
class PostureMean {
 public:
  /// A comparison of the posture that the robot stands in.
  void add(const PoseCheck& check);
  /// The robot has left it.
  void end_posture();

  /// Nothing: it is of too few postures.
  std::optional<RobotShift> shift() const;

 private:
  Matrix6d information_ = Matrix6d::Zero();  // about the base's origin
  Vector6d pull_ = Vector6d::Zero();
  Eigen::Vector3d middle_base_ = Eigen::Vector3d::Zero();  // mean of the last postures
  Matrix6d pose_covariance_ = Matrix6d::Zero();            // about the base's origin
  int postures_ = 0;

  struct Posture {
    PoseCheck newest;
    Vector6d turn_shift = Vector6d::Zero();  // mean of its comparisons, about the base's origin
    int checks = 0;
  } posture_;
};

}  // namespace calibrd
