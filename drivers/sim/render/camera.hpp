// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// The simulated lens. Written apart from core's camera model, so that a test can hold one against the other.
class Camera {
 public:
  explicit Camera(const CameraParameters& parameters);

  const CameraParameters& parameters() const { return p_; }
  bool is_distorted() const { return distorted_; }

  /// Normalised image coordinates (x/z, y/z) that the lens brings to pixel (u, v).
  Eigen::Vector2d undistorted(double u, double v) const;

  /// Pixel of normalised image coordinates.
  Eigen::Vector2d pixel(const Eigen::Vector2d& normalised) const;

 private:
  Eigen::Vector2d distorted(double x, double y) const;

  CameraParameters p_;
  bool distorted_;
};

}  // namespace calibrd::sim
