// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/geometry/camera_model.hpp"

namespace calibrd {

/// The direction each pixel of a camera sees along, distortion undone once. Immutable: safe to read from any
/// thread.
class PixelRays {
 public:
  explicit PixelRays(const CameraModel& camera);

  /// Direction with z = 1 (sensor frame) of pixel (x, y), which must lie in the image.
  Eigen::Vector3d at(int x, int y) const {
    const Eigen::Vector2d& direction =
        directions_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                    static_cast<std::size_t>(x)];
    return {direction.x(), direction.y(), 1.0};
  }
  const CameraModel& camera() const { return camera_; }

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector2d> directions_;
};

}  // namespace calibrd
