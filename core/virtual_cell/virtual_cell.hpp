// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/camera_model.hpp"
#include "core/geometry/pixel_rays.hpp"
#include "core/geometry/pose.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// What a virtual sensor measures: one entry per pixel, row-major, every pixel written.
struct VirtualMeasurement {
  int width = 0;
  int height = 0;
  std::vector<float> depth_m;  ///< along the optical axis; 0 = nothing hit
  std::vector<Eigen::Vector3f>
      normal;                      ///< unit, sensor frame, towards the sensor; zero where nothing was hit
  std::vector<std::int16_t> link;  ///< index into RobotModel::links(); -1 = nothing hit

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// What one ray meets.
struct SurfaceHit {
  float depth_m = 0;                                 ///< along the optical axis; 0 = nothing hit
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, sensor frame, towards the sensor
};

/// A point of the robot's surface.
struct SurfacePoint {
  int link = -1;  ///< index into RobotModel::links()
  Eigen::Vector3d point_base = Eigen::Vector3d::Zero();
  double distance_m = 0;  ///< from the point it was asked for
};

/// The robot placed at joint positions, measured by a virtual sensor from any pose (Embree ray casting).
/// hit_along() and nearest_surface() may be called from any number of threads, measure() and set_joints()
/// from one at a time. `robot` must outlive it.
class VirtualCell {
 public:
  explicit VirtualCell(const RobotModel& robot);
  /// A second cell with joints of its own; the link surfaces are shared, so a copy is cheap.
  VirtualCell(const VirtualCell& other);
  VirtualCell& operator=(const VirtualCell&) = delete;
  ~VirtualCell();
  VirtualCell(VirtualCell&&) noexcept;
  VirtualCell& operator=(VirtualCell&&) noexcept;

  /// Moves the robot. positions: RobotModel::position_names() order, rad or m.
  void set_joints(std::span<const double> positions);

  /// Depth image, normals and link ids seen from `T_base_sensor`, lens distortion included. Reuses the
  /// buffers of `measurement`.
  void measure(const CameraModel& camera, const Pose& T_base_sensor, VirtualMeasurement& measurement) const;

  /// What one direction (sensor frame, z = 1) meets, seen from `T_base_sensor`.
  SurfaceHit hit_along(const Eigen::Vector3d& direction_sensor, const Pose& T_base_sensor) const;

  /// The point of the robot's surface nearest to `point_base` (m), exact on its triangles; nothing when it is
  /// not closer than `within_m`.
  std::optional<SurfacePoint> nearest_surface(const Eigen::Vector3d& point_base, double within_m) const;

  const RobotModel& robot() const;

  /// The viewing directions of a camera, made once for this cell and its copies.
  std::shared_ptr<const PixelRays> pixel_rays(const CameraModel& camera) const;

  /// T_base_link of every link of the robot at the current joints.
  const std::vector<Pose>& link_poses() const;

 private:
  void place(std::vector<Pose> T_base_link);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrd
