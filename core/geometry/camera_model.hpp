// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>

namespace calibrd {

/// Pinhole camera with OpenCV's radial-tangential distortion (k1, k2, p1, p2, k3), one grid for depth and
/// image. Sensor frame: x right, y down, z forward. Pixel centres are whole numbers: pixel (x, y) of the
/// first row is (x, 0). Lengths in pixels.
struct CameraModel {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{0, 0, 0, 0, 0};

  bool operator==(const CameraModel&) const = default;
  bool is_distorted() const { return distortion != std::array<double, 5>{0, 0, 0, 0, 0}; }

  /// Direction with z = 1 that pixel (u, v) sees (sensor frame), distortion undone.
  Eigen::Vector3d ray(double u, double v) const;

  /// Pixel that sees the point (sensor frame, m; z > 0).
  Eigen::Vector2d project(const Eigen::Vector3d& point_sensor) const;

  /// Derivative of project() by the point: 2×3, pixels per metre.
  Eigen::Matrix<double, 2, 3> projection_jacobian(const Eigen::Vector3d& point_sensor) const;

  /// The camera whose pixels cover `side` by `side` pixels of this one; what is left over is cut off.
  CameraModel binned(int side) const;

  /// The camera that has every `step`-th pixel of this one in both directions: its pixel (x, y) sees what
  /// pixel (step x, step y) of this one sees.
  CameraModel subsampled(int step) const;
};

}  // namespace calibrd
