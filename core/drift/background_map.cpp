// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_map.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/registration/depth_noise.hpp"

namespace calibrd {
namespace {

/// Depths of one pixel in several views are of one surface when they lie within this, m.
constexpr float kSameSurface_m = 0.025F;
/// Neighbours of a cell may lie this far off its plane, as a share of the depth and in m, or it is an edge.
constexpr double kOffPlane = 0.004, kLeastOffPlane_m = 0.004;
constexpr double kMinCosine = 0.2;
constexpr int kReach = 2;   // cells to each side that a plane is fitted to
constexpr int kMargin = 2;  // cells around the robot that may be robot: flying pixels, joints a moment off

/// Mean and size of the largest group of values within kSameSurface_m; 0 when it is no majority. Sorts
/// `values`.
std::pair<float, std::size_t> agreed_depth(std::vector<float>& values) {
  if (values.empty()) return {0, 0};
  std::ranges::sort(values);
  std::size_t best_begin = 0, best_count = 0;
  for (std::size_t begin = 0, end = 0; begin < values.size(); ++begin) {
    while (end < values.size() && values[end] - values[begin] <= kSameSurface_m) ++end;
    if (end - begin >= best_count) {  // of equal groups the farther one: what passes by is in front
      best_count = end - begin;
      best_begin = begin;
    }
  }
  if (2 * best_count <= values.size() && values.size() > 1) return {0, 0};
  float sum = 0;
  for (std::size_t i = best_begin; i < best_begin + best_count; ++i) sum += values[i];
  return {sum / static_cast<float>(best_count), best_count};
}

}  // namespace

void BackgroundMap::learn(std::span<const View> views, std::span<const std::vector<std::uint8_t>> robot) {
  std::vector<float> values;
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) {
      const auto cell = static_cast<std::size_t>(y * grid_.width + x);
      values.clear();
      for (std::size_t v = 0; v < views.size(); ++v) {
        if (robot[v][cell] != 0) continue;
        const double z = views[v].depth.depth_m(kBackgroundStride * x, kBackgroundStride * y);
        if (z > 0) values.push_back(static_cast<float>(z));
      }
      const auto [depth_m, count] = agreed_depth(values);
      cells_[cell].depth_m = depth_m;
      cells_[cell].frames = static_cast<float>(count);
    }
  }
  fit_planes();
}

void BackgroundMap::recall(std::span<const float> depth_m, int views) {
  if (depth_m.size() != cells_.size()) return;
  is_recalled_ = true;
  // The robot hides a cell in some of the views; half of them is what a cell has on the whole.
  const auto frames = static_cast<float>(std::max(1, views / 2));
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].depth_m = depth_m[i];
    cells_[i].frames = frames;
  }
  fit_planes();
}

std::vector<float> BackgroundMap::depths_m() const {
  std::vector<float> depths;
  for (const BackgroundCell& cell : cells_) depths.push_back(cell.depth_m);
  return depths;
}

void BackgroundMap::relearn(std::span<const float> depth_m, std::span<const float> frames,
                            std::span<const std::uint8_t> chosen) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (chosen[i] == 0) continue;
    cells_[i].depth_m = depth_m[i];
    cells_[i].frames = frames[i];
  }
  fit_planes();
}

void BackgroundMap::refine(std::span<const float> depth_m, std::span<const std::uint8_t> chosen) {
  if (is_recalled_) return;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    BackgroundCell& cell = cells_[i];
    if (chosen[i] == 0 || depth_m[i] <= 0 || cell.depth_m <= 0 || cell.frames >= kMostFrames) continue;
    cell.frames += 1;
    cell.depth_m += (depth_m[i] - cell.depth_m) / cell.frames;
  }
}

void BackgroundMap::fit_planes() {
  planes_ = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) {
      BackgroundCell& cell = cells_[static_cast<std::size_t>(y * grid_.width + x)];
      cell.normal_per_m.setZero();
      fit_plane(x, y);
      if (!cell.has_plane()) continue;
      ++planes_;
      sum += static_cast<double>(cell.depth_m) * rays_.at(x, y);
    }
  }
  if (planes_ > 0) middle_sensor_ = sum / static_cast<double>(planes_);
}

/// On a plane the inverse depth is linear in the viewing direction: 1/z = m · d.
void BackgroundMap::fit_plane(int x, int y) {
  if (x < kReach || y < kReach || x + kReach >= grid_.width || y + kReach >= grid_.height) return;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int v = y - kReach; v <= y + kReach; ++v) {
    for (int u = x - kReach; u <= x + kReach; ++u) {
      const double z = cells_[static_cast<std::size_t>(v * grid_.width + u)].depth_m;
      if (z <= 0) return;
      const Eigen::Vector3d d = rays_.at(u, v);
      normal += d * d.transpose();
      right += d / z;
    }
  }
  const Eigen::Vector3d m = normal.ldlt().solve(right);
  BackgroundCell& cell = cells_[static_cast<std::size_t>(y * grid_.width + x)];
  const double z = cell.depth_m, allowed = std::max(kLeastOffPlane_m, kOffPlane * z);
  for (int v = y - kReach; v <= y + kReach; ++v)
    for (int u = x - kReach; u <= x + kReach; ++u) {
      const double there = cells_[static_cast<std::size_t>(v * grid_.width + u)].depth_m;
      if (!(std::abs(1 / m.dot(rays_.at(u, v)) - there) < allowed)) return;
    }
  const Eigen::Vector3d d = rays_.at(x, y);
  const double cosine = m.dot(d) / (m.norm() * d.norm());
  if (!(cosine > kMinCosine)) return;
  cell.normal_per_m = m.cast<float>();
  cell.sigma_m = static_cast<float>(depth_sigma_m(z, cosine, 1 / (kBackgroundStride * grid_.fx)));
  const double sigma = cell.sigma_m / (z * z);  // of the inverse depth
  cell.normal_noise = (sigma * sigma / std::max(1.0F, cell.frames) * normal.inverse()).cast<float>();
}

const std::vector<std::uint8_t>& RobotMask::at(std::span<const double> positions, const Pose& T_base_sensor) {
  cell_.set_joints(positions);
  cell_.measure(grid_, T_base_sensor, prediction_);
  mask_.assign(prediction_.link.size(), 0);
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) {
      if (prediction_.link[prediction_.index(x, y)] < 0) continue;
      for (int v = std::max(0, y - kMargin); v <= std::min(grid_.height - 1, y + kMargin); ++v)
        std::fill_n(mask_.begin() + v * grid_.width + std::max(0, x - kMargin),
                    std::min(grid_.width - 1, x + kMargin) - std::max(0, x - kMargin) + 1, std::uint8_t{1});
    }
  }
  return mask_;
}

BackgroundMap learn_background(RobotMask& robot, const CameraModel& camera, std::span<const View> views,
                               const Pose& T_base_sensor) {
  std::vector<std::vector<std::uint8_t>> masks;
  for (const View& view : views) masks.push_back(robot.at(view.joint_positions_rad, T_base_sensor));
  BackgroundMap background(camera);
  background.learn(views, masks);
  return background;
}

}  // namespace calibrd
