// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "drivers/sim/render/camera.hpp"

namespace calibrd::sim {

/// Every pixel is looked at along 3x3 rays. They lie on a slightly turned grid, so that all nine differ in x and all
/// nine differ in y: an upright edge then moves through nine levels of grey and not three. The middle ray is that of
/// the pixel's centre.
inline constexpr int kSubSamples = 3;

/// Rows of samples are as long as a multiple of this; those past the image's edge are never looked at.
inline constexpr int kRowStep = 4;

/// The rays of all samples, row by row; ray (x, y, 1) in the sensor frame. Lens distortion is in here and nowhere
/// else in the renderer.
struct SampleGrid {
  explicit SampleGrid(const CameraParameters& parameters);

  /// Where sample (sx, sy) lies in the image, in pixels.
  static Eigen::Vector2d position(int sx, int sy);

  std::size_t index(int sx, int sy) const {
    return static_cast<std::size_t>(sy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(sx);
  }

  Camera camera;
  int width, height;  ///< in samples
  std::vector<float> ray_x, ray_y;
  Eigen::Vector2d lowest, highest;   ///< range of the rays
  double largest_displacement_px;    ///< by the lens, anywhere in the image
};

inline constexpr float kNothing = std::numeric_limits<float>::infinity();

/// What each sample sees: depth along the optical axis (m; kNothing = nothing) and the facet that was hit.
struct SampleBuffer {
  explicit SampleBuffer(const SampleGrid& grid) : depth(grid.ray_x.size(), kNothing), facet(grid.ray_x.size(), 0) {}
  std::vector<float> depth;
  std::vector<std::uint32_t> facet;
};

}  // namespace calibrd::sim
