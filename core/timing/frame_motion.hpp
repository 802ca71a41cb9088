// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/sensing/depth_correction.hpp"
#include "core/sensing/images.hpp"
#include "core/timing/offset_filter.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// Joint positions (RobotModel::position_names() order) at a moment, as the stamps have it; nothing where
/// they are not known.
using JointsAt = std::function<std::optional<std::vector<double>>(Clock::time_point)>;

/// A frame as it came, and what is believed of the sensor.
struct TimedFrame {
  const DepthImage& depth;
  Clock::time_point stamp;  ///< of the exposure, as far as latencies are configured
  const Pose& T_base_sensor;
  const DepthCorrection& correction;
};

struct FrameMotionSettings {
  int stride = 4;                   ///< every stride-th pixel in both directions is predicted and compared
  double kernel_m = 0.03;           ///< residuals beyond this have no weight (Tukey's biweight)
  double min_cos_incidence = 0.25;  ///< flatter surfaces say more about the pixel grid
  std::size_t min_pixels = 120;     ///< compared ones that agree
};

/// What a frame of a moving robot says about the time offset dt: the depth the sensor should see with the
/// joints of `stamp - dt` against what it has measured. Keeps its buffers. One thread at a time.
class FrameMotion {
 public:
  /// Shares the surfaces of `cell`, whose robot must outlive it.
  FrameMotion(const VirtualCell& cell, const CameraModel& camera, const FrameMotionSettings& settings = {});

  /// How badly the frame fits `dt_s` (0: at all its pixels, 1: at none); nothing when too few pixels say so.
  std::optional<double> misfit(const TimedFrame& frame, const JointsAt& joints_at, double dt_s);

  /// The frame's equations around `dt_s`; nothing when the joints around it are not known, or too few pixels
  /// agree.
  std::optional<OffsetEquations> observe(const TimedFrame& frame, const JointsAt& joints_at, double dt_s);

 private:
  struct Pixel {
    std::size_t index;  // of the sparse grid
    double z, slope;    // predicted depth; n·ray, below 0
    double residual;    // measured minus predicted
    std::size_t cluster;
  };
  bool place(const JointsAt& joints_at, Clock::time_point time);
  void compare(const TimedFrame& frame);

  FrameMotionSettings settings_;
  CameraModel camera_, sparse_camera_;
  VirtualCell cell_;
  std::vector<Eigen::Vector3d> rays_;  // of the sparse grid, z = 1
  VirtualMeasurement prediction_;
  std::vector<Pixel> pixels_;
};

}  // namespace calibrd
