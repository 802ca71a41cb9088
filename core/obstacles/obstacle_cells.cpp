// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/obstacle_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace calibrd {
namespace {

/// Neighbouring pixels of one surface differ by less: noise, and a slope of 75°.
constexpr double kNoise_m = 0.005, kSurfaceSlope = 3.7;
constexpr int kLeastNeighbours = 5;
/// Planes around a gap of the background are taken to go on across so many cells ...
constexpr int kAcross = 32;
/// ... to within this, the less certain the farther.
constexpr double kOnPlane_m = 0.02, kOnPlanePerCell_m = 0.0025;

/// What is so far in front of the robot is neither the robot nor a cable along it.
constexpr double kBeforeRobot_m = 0.05;
constexpr int kAroundRobot = 3;  // cells, at least the margin of RobotMask

bool is_before_robot(float robot_m, double measured_m) {
  return measured_m < static_cast<double>(robot_m) - kBeforeRobot_m;
}

/// A surface that is remembered nearby goes on to here: behind where the robot stood, and along edges.
bool is_background_gone_on(const BackgroundMap& background, int x, int y, double depth_m) {
  constexpr std::array<std::array<int, 2>, 8> kDirections{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  const CameraModel& grid = background.grid();
  const Eigen::Vector3d direction = background.rays().at(x, y);
  for (const auto& [dx, dy] : kDirections) {
    for (int step = 1; step <= kAcross; ++step) {
      const int u = x + step * dx, v = y + step * dy;
      if (u < 0 || v < 0 || u >= grid.width || v >= grid.height) break;
      const BackgroundCell& cell = background.cells()[static_cast<std::size_t>(v * grid.width + u)];
      if (!cell.has_plane()) continue;
      const double expected = 1 / cell.normal_per_m.cast<double>().dot(direction);
      if (std::abs(depth_m - expected) < kOnPlane_m + kOnPlanePerCell_m * step) return true;
      break;
    }
  }
  return false;
}

}  // namespace

double surface_depth_m(const DepthImage& depth, const CameraModel& camera, int x, int y) {
  const double z = depth.depth_m(x, y);
  if (z <= 0 || x < 1 || y < 1 || x + 1 >= depth.width || y + 1 >= depth.height) return 0;
  const double allowed = kNoise_m + kSurfaceSlope * z / camera.fx;
  double sum = z;
  int neighbours = 0;
  for (int v = y - 1; v <= y + 1; ++v) {
    for (int u = x - 1; u <= x + 1; ++u) {
      const double there = depth.depth_m(u, v);
      if ((u == x && v == y) || there <= 0 || std::abs(there - z) > allowed) continue;
      sum += there;
      ++neighbours;
    }
  }
  return neighbours < kLeastNeighbours ? 0 : sum / (neighbours + 1);
}

std::vector<float> robot_around(std::span<const std::uint8_t> mask, const VirtualMeasurement& prediction) {
  std::vector<float> robot_m(mask.size(), 0);
  for (int y = 0; y < prediction.height; ++y) {
    for (int x = 0; x < prediction.width; ++x) {
      float& nearest = robot_m[prediction.index(x, y)];
      if (mask[prediction.index(x, y)] == 0) continue;
      for (int v = std::max(0, y - kAroundRobot); v <= std::min(prediction.height - 1, y + kAroundRobot); ++v)
        for (int u = std::max(0, x - kAroundRobot); u <= std::min(prediction.width - 1, x + kAroundRobot);
             ++u)
          if (const float z = prediction.depth_m[prediction.index(u, v)];
              z > 0 && (nearest <= 0 || z < nearest))
            nearest = z;
    }
  }
  return robot_m;
}

bool may_be_known(const ExpectedCells& expected, const CameraModel& camera, int x, int y, double measured_m) {
  const CameraModel& grid = expected.background.grid();
  const Eigen::Vector3d direction = camera.ray(x, y);
  const int left = x / kBackgroundStride, top = y / kBackgroundStride;
  for (int v = top; v <= std::min(top + 1, grid.height - 1); ++v)
    for (int u = left; u <= std::min(left + 1, grid.width - 1); ++u) {
      const auto i = static_cast<std::size_t>(v * grid.width + u);
      const float robot_m = expected.robot_m[i];
      if (robot_m > 0 && !is_before_robot(robot_m, measured_m)) return true;
      const BackgroundCell& cell = expected.background.cells()[i];
      if (!cell.has_plane()) continue;
      if (std::abs(measured_m - 1 / cell.normal_per_m.cast<double>().dot(direction)) < kOnPlane_m)
        return true;
    }
  return false;
}

std::vector<Foreign> foreign_cells(const ExpectedCells& expected, const CameraModel& camera,
                                   const DepthImage& depth) {
  const BackgroundMap& background = expected.background;
  const CameraModel& grid = background.grid();
  std::vector<Foreign> foreign(expected.states.size(), Foreign::no);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto cell = static_cast<std::size_t>(y * grid.width + x);
      const CellState state = expected.states[cell];
      const float robot_m = expected.robot_m[cell];
      if (robot_m <= 0 && state != CellState::nearer && state != CellState::unknown) continue;
      const double z = surface_depth_m(depth, camera, kBackgroundStride * x, kBackgroundStride * y);
      if (z <= 0 || (robot_m > 0 && !is_before_robot(robot_m, z))) continue;
      if (state != CellState::unknown || robot_m > 0)
        foreign[cell] = Foreign::before_known;
      else if (!is_background_gone_on(background, x, y, z))
        foreign[cell] = Foreign::background_not_known;
    }
  }
  return foreign;
}

}  // namespace calibrd
