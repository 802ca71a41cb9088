// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/frame_pixels.hpp"

#include <cmath>

namespace calibrd {
namespace {

/// A measured step to a direct neighbour, as a share of the depth, beyond which a pixel mixes two surfaces;
/// and how far a predicted neighbour may lie off the pixel's tangent plane before the pixel counts as rim.
constexpr double kMixedStep = 0.025, kRimStep = 0.025;

}  // namespace

double measured_m(const DepthImage& depth, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= depth.width || y + 1 >= depth.height) return 0;
  const double z = depth.depth_m(x, y);
  const auto differs = [&](int nx, int ny) {
    const double neighbour = depth.depth_m(nx, ny);
    return neighbour <= 0 || std::abs(neighbour - z) >= kMixedStep * z;
  };
  return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1) ? 0 : z;
}

bool is_rim(const VirtualMeasurement& prediction, std::span<const Eigen::Vector3d> rays, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= prediction.width || y + 1 >= prediction.height) return true;
  const std::size_t i = prediction.index(x, y), row = static_cast<std::size_t>(prediction.width);
  const Eigen::Vector3d n = prediction.normal[i].cast<double>();
  const double plane = n.dot(rays[i]) * prediction.depth_m[i];
  for (const std::size_t j : {i - 1, i + 1, i - row, i + row}) {
    const double z = prediction.depth_m[j];
    if (std::abs(n.dot(rays[j]) * z - plane) > kRimStep * std::abs(plane)) return true;
  }
  return false;
}

}  // namespace calibrd
