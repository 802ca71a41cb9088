// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pixel_rays.hpp"
#include "core/registration/joint_axes.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// A view made ready for registration: the robot stands at its joints, the depth is in metres, and pixels
/// that mix two surfaces (depth edges) are gone.
struct RegistrationView {
  VirtualCell cell;
  std::vector<double> reported_joints;  ///< RobotModel::position_names() order, rad or m
  JointAxes axes;                       ///< at the cell's joints
  std::vector<float> depth_m;           ///< measured, row-major; 0 = nothing usable
  std::vector<float> image;             ///< smoothed grey values, row-major; empty when there is none
  double image_noise =
      0;  ///< standard deviation of `image`'s horizontal differences without edges, grey values
  std::shared_ptr<const PixelRays> rays;  ///< of the camera the view was taken with

  /// Puts the robot where the reported joints and these zeros put it.
  void apply_zeros(const JointZeros& zeros);
};

struct PrepareSettings {
  /// A pixel is mixed when a direct neighbour lies further away in depth than this share of its depth. A
  /// smooth surface at 80° incidence steps 2 % per pixel on a Kinect v2.
  double mixed_step = 0.025;
  bool use_images = true;
};

/// Copies the virtual cell once per view (surfaces shared) and cleans the measurements.
std::vector<RegistrationView> prepare_views(const VirtualCell& cell, const CameraModel& camera,
                                            std::span<const View> views, const PrepareSettings& settings);

}  // namespace calibrd
