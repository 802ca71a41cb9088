// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "core/calibration/check_pose.hpp"
#include "core/drift/background_map.hpp"
#include "core/drift/background_match.hpp"

namespace calibrd {

/// A move of the sensor between two of the views that a pose was found from.
struct MovedMeanwhile {
  enum class Witness { background, robot } witness = Witness::background;
  std::size_t before = 0;            ///< the last view from the first place
  double shift_m = 0, turn_rad = 0;  /// of what the witness is
};

/// What all splits of the views into those before and those after a move say of it.
struct SplitOfViews {
  std::size_t before = 0;                  ///< the last view before it
  double squares = 0;                      ///< of the shift, against its covariance: χ² of 6
  Vector6d turn_shift = Vector6d::Zero();  ///< rad and m, base axes
};

/// Views of a sensor that was knocked while they were collected fit one pose between the two, with residuals
/// that look like a model's faults: a wrong pose with a good word. So they are held against each other in the
/// order of their time: each one's background against that of the first and of the one before it, and what
/// the robot shows before against what it shows after every moment. Without I/O; one thread.
class ViewsInOrder {
 public:
  /// The robot of `cell` must outlive it.
  ViewsInOrder(const VirtualCell& cell, const CameraModel& camera);

  /// `views`: one or more, by time, with joints. `T_base_sensor`, `correction`: found from them.
  std::optional<MovedMeanwhile> find_move(std::span<const View> views, const Pose& T_base_sensor,
                                          const DepthCorrection& correction);

  /// Where the backgrounds show the largest shift, in squares of what is tolerated; and the robot.
  SplitOfViews background_split(std::span<const View> views, const Pose& T_base_sensor);
  SplitOfViews robot_split(std::span<const View> views, const Pose& T_base_sensor,
                           const DepthCorrection& correction);

 private:
  std::optional<BackgroundObservation> match(const View& remembered, const View& now,
                                             const Pose& T_base_sensor);

  CameraModel camera_;
  Eigen::Vector3d middle_sensor_ = Eigen::Vector3d::Zero();  // of what was remembered last
  RobotMask robot_;
  PoseChecker checker_;
};

}  // namespace calibrd
