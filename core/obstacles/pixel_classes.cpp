// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/pixel_classes.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kOnRobot_m = 0.03;       // bias of the sensor, joint zeros, cables along the arm
constexpr double kOnBackground_m = 0.02;  // as obstacles are told from it
constexpr double kOnEdge_m = 0.08;        // cells without a plane lie on edges: depth jumps within them
constexpr int kOutline = 4;               // pixels of the sensor: how far its range blurs an outline

struct Around {
  bool is_background = false, is_remembered = false;
};

/// What the background's cells around a pixel say of its depth.
Around look_at_background(const BackgroundMap& background, const Eigen::Vector3d& ray, int x, int y,
                          double depth_m) {
  const CameraModel& grid = background.grid();
  const int left = x / kBackgroundStride, top = y / kBackgroundStride;  // x, y: pixel of the sensor
  Around around;
  for (int v = top; v <= std::min(top + 1, grid.height - 1); ++v)
    for (int u = left; u <= std::min(left + 1, grid.width - 1); ++u) {
      const BackgroundCell& cell = background.cells()[static_cast<std::size_t>(v * grid.width + u)];
      if (cell.depth_m <= 0) continue;
      around.is_remembered = true;
      const double expected = cell.has_plane() ? 1 / cell.normal_per_m.cast<double>().dot(ray)
                                               : static_cast<double>(cell.depth_m);
      const double allowed = cell.has_plane() ? kOnBackground_m : kOnEdge_m;
      if (std::abs(depth_m - expected) < allowed) around.is_background = true;
    }
  return around;
}

/// The robot is predicted at the pixel or near it, where an outline is blurred, and about as far away.
bool is_robot(const PixelEvidence& evidence, int x, int y, double depth_m) {
  const VirtualMeasurement& robot = evidence.robot;
  if (robot.depth_m.empty()) return false;
  const int reach = std::max(1, kOutline / evidence.step);
  for (int v = std::max(0, y - reach); v <= std::min(robot.height - 1, y + reach); ++v)
    for (int u = std::max(0, x - reach); u <= std::min(robot.width - 1, x + reach); ++u) {
      const double predicted_m = robot.depth_m[robot.index(u, v)];
      if (predicted_m > 0 && std::abs(depth_m - predicted_m) < kOnRobot_m) return true;
    }
  return false;
}

}  // namespace

std::vector<PixelClass> classify_pixels(const PixelEvidence& evidence) {
  const CameraModel& grid = evidence.rays.camera();
  std::vector<PixelClass> classes;
  classes.reserve(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const int u = x * evidence.step, v = y * evidence.step;
      const double depth_m = evidence.depth.depth_m(u, v);
      auto& found = classes.emplace_back(PixelClass::nothing);
      if (depth_m <= 0) continue;
      found = PixelClass::unknown;
      if (is_robot(evidence, x, y, depth_m)) {
        found = PixelClass::robot;
      } else if (evidence.background) {
        const auto around = look_at_background(*evidence.background, evidence.rays.at(x, y), u, v, depth_m);
        if (around.is_remembered)
          found = around.is_background ? PixelClass::background : PixelClass::unexpected;
      }
    }
  return classes;
}

}  // namespace calibrd
