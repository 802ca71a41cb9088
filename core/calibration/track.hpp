// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

#include "core/base/result.hpp"
#include "core/calibration/track_error.hpp"
#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/sensing/depth_correction.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

struct TrackSettings {
  /// Every stride-th pixel in both directions is predicted and compared. On simulated captures 2 takes 2 ms
  /// and is as good as 1, which takes seven times as long; 4 takes 0.7 ms and doubles the errors.
  int stride = 2;
  int steps = 2;  ///< Gauss-Newton steps, each with a prediction of its own; a third changes nothing
  double first_kernel_m = 0.03;     ///< residuals beyond this have no weight in the first step (Tukey)
  double offset_prior_m = 0.001;    ///< how far the range offset may have wandered since it was calibrated
  double min_cos_incidence = 0.25;  ///< flatter surfaces say more about the pixel grid than about the pose
  std::size_t min_pixels = 150;     ///< compared ones that agree
};

/// What one frame says about a pose that was good before it.
struct TrackedPose {
  Pose T_base_sensor = Pose::Identity();
  double offset_change_m = 0;              ///< of the range, against the correction given
  Vector6d innovation = Vector6d::Zero();  ///< difference(start, T_base_sensor)
  /// Of the innovation while the sensor stands: noise, its correlation, the offset's prior. What is wrong
  /// with the model or the joint zeros comes on top, and stays the same from frame to frame of one posture.
  Matrix6d covariance = Matrix6d::Zero();
  double sigma_factor = 1;      ///< noise found over depth_sigma_m()
  std::size_t measured = 0;     ///< predicted robot pixels that carry a measurement ...
  std::size_t agreeing = 0;     ///< ... and agree with the prediction
  double last_step_sigmas = 0;  ///< length of the last step against the uncertainty of the result
};

/// Follows the pose of one sensor from frame to frame: range residuals of one depth frame on projective pairs
/// (as add_range_residuals() has them), pose and range offset free, the joints taken as reported. Keeps its
/// buffers from frame to frame. One thread at a time.
class PoseTracker {
 public:
  /// Shares the surfaces of `cell`, whose robot must outlive it.
  PoseTracker(const VirtualCell& cell, const CameraModel& camera, const TrackSettings& settings = {});

  /// Improves `T_base_sensor`, good to about a centimetre at the robot, by the view's depth.
  /// Errors: TrackError.
  Result<TrackedPose> update(const View& view, const Pose& T_base_sensor, const DepthCorrection& correction);

 private:
  struct Sums;
  struct Weighing {
    double kernel_m, sigma_factor;
  };
  Status check(const View& view) const;
  Sums collect(const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
               const Weighing& weighing);
  void compare_row(int row, const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
                   const Weighing& weighing, Sums& sums) const;
  bool step(const Sums& sums, double scatter, TrackedPose& tracked) const;

  TrackSettings settings_;
  CameraModel camera_, sparse_camera_;
  VirtualCell cell_;
  std::vector<Eigen::Vector3d> rays_;  // of the sparse grid, z = 1
  VirtualMeasurement prediction_;
};

}  // namespace calibrd
