// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pixel_rays.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

/// Every this many pixels of the sensor, in both directions, is one cell of what the watch remembers.
constexpr int kBackgroundStride = 4;

/// The tangent plane at one cell of the background, sensor frame: normal_per_m · p = 1 for its points.
struct BackgroundCell {
  float depth_m = 0;  ///< along the optical axis, as the sensor measured it; 0 = nothing known
  Eigen::Vector3f normal_per_m = Eigen::Vector3f::Zero();  ///< zero: no plane, an edge
  Eigen::Matrix3f normal_noise = Eigen::Matrix3f::Zero();  ///< covariance of it
  float sigma_m = 0;                                       ///< of one frame's depth here
  float frames = 0;                                        ///< that depth_m is the mean of
  bool has_plane() const { return normal_per_m != Eigen::Vector3f::Zero(); }
};

/// What a sensor sees of the cell where the robot is not, as it was when its pose was found: the same sensor
/// measured it, so neither its bias nor a model is between the two. Row-major cells of camera.subsampled().
class BackgroundMap {
 public:
  explicit BackgroundMap(const CameraModel& camera)
      : grid_(camera.subsampled(kBackgroundStride)), rays_(grid_), cells_(size_of(grid_)) {}

  /// Learns from views of one sensor that stood still. Of each pixel that depth counts which most of the
  /// views agree on, where the robot is not; `robot` holds one coarse mask per view (see RobotMask).
  void learn(std::span<const View> views, std::span<const std::vector<std::uint8_t>> robot);

  /// Takes depths that were learnt before from about `views` views: one per cell, m, 0 = nothing known.
  /// Others are ignored. From then on it is there to be compared with: refine() leaves it as it is.
  void recall(std::span<const float> depth_m, int views);
  /// What recall() takes.
  std::vector<float> depths_m() const;

  /// Takes `depth_m`, each the mean of `frames` frames, for the `chosen` cells (row-major, 1 = chosen).
  void relearn(std::span<const float> depth_m, std::span<const float> frames,
               std::span<const std::uint8_t> chosen);
  /// Takes one more frame into the means of the `chosen` cells, whose planes stay what they are. No mean is
  /// of more than kMostFrames: what comes later is to be compared with it, not to become part of it.
  void refine(std::span<const float> depth_m, std::span<const std::uint8_t> chosen);
  static constexpr float kMostFrames = 60;
  /// The planes from the means as they are by now.
  void fit_planes();

  /// Too little to say anything of the pose.
  bool is_empty() const { return planes_ == 0; }
  std::size_t planes() const { return planes_; }
  const CameraModel& grid() const { return grid_; }
  const PixelRays& rays() const { return rays_; }
  const std::vector<BackgroundCell>& cells() const { return cells_; }
  /// Mean of the points that have a plane, sensor frame, m.
  Eigen::Vector3d middle_sensor() const { return middle_sensor_; }

 private:
  static std::size_t size_of(const CameraModel& grid) {
    return static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  }
  void fit_plane(int x, int y);

  CameraModel grid_;
  PixelRays rays_;
  std::vector<BackgroundCell> cells_;
  std::size_t planes_ = 0;
  bool is_recalled_ = false;
  Eigen::Vector3d middle_sensor_ = Eigen::Vector3d::Zero();
};

/// Where the virtual robot hides the background, on the cells of a background map, a margin around it.
class RobotMask {
 public:
  /// Shares the surfaces of `cell`, whose robot must outlive it.
  RobotMask(const VirtualCell& cell, const CameraModel& camera)
      : cell_(cell), grid_(camera.subsampled(kBackgroundStride)) {}

  /// `positions`: of the frame's moment, position_names() order. 1 = robot, or so near its outline that it
  /// may be.
  const std::vector<std::uint8_t>& at(std::span<const double> positions, const Pose& T_base_sensor);
  /// The robot at the joints of the last at() ...
  const VirtualCell& cell() const { return cell_; }
  /// ... and what of it the cells see.
  const VirtualMeasurement& prediction() const { return prediction_; }

 private:
  VirtualCell cell_;
  CameraModel grid_;
  VirtualMeasurement prediction_;
  std::vector<std::uint8_t> mask_;
};

/// The background that `views` of a sensor that stood at `T_base_sensor` show, as BackgroundMap::learn().
BackgroundMap learn_background(RobotMask& robot, const CameraModel& camera, std::span<const View> views,
                               const Pose& T_base_sensor);

}  // namespace calibrd
