// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/sample_grid.hpp"

#include <algorithm>

namespace calibrd::sim {

Eigen::Vector2d SampleGrid::position(int sx, int sy) {
  constexpr double kPitch = 1.0 / kSubSamples, kTurn = kPitch / kSubSamples;
  const int i = sx % kSubSamples - 1, j = sy % kSubSamples - 1;
  return {sx / kSubSamples + kPitch * i + kTurn * j, sy / kSubSamples + kPitch * j - kTurn * i};
}

SampleGrid::SampleGrid(const CameraParameters& parameters)
    : camera(parameters),
      width((parameters.width * kSubSamples + kRowStep - 1) / kRowStep * kRowStep),
      height(parameters.height * kSubSamples),
      lowest(Eigen::Vector2d::Constant(kNothing)),
      highest(Eigen::Vector2d::Constant(-kNothing)),
      largest_displacement_px(0) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  ray_x.reserve(count);
  ray_y.reserve(count);
  const CameraParameters& p = parameters;
  for (int sy = 0; sy < height; ++sy)
    for (int sx = 0; sx < width; ++sx) {
      const Eigen::Vector2d at = position(sx, sy), ray = camera.undistorted(at.x(), at.y());
      ray_x.push_back(static_cast<float>(ray.x()));
      ray_y.push_back(static_cast<float>(ray.y()));
      lowest = lowest.cwiseMin(ray);
      highest = highest.cwiseMax(ray);
      const Eigen::Vector2d pinhole(p.cx + p.fx * ray.x(), p.cy + p.fy * ray.y());
      largest_displacement_px = std::max(largest_displacement_px, (pinhole - at).cwiseAbs().maxCoeff());
    }
}

}  // namespace calibrd::sim
