// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_align.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace calibrd {
namespace {

constexpr int kAlignSteps = 18, kStep_cells = 2;
constexpr double kFirstKernel_m = 0.2, kLastKernel_m = 0.02, kNarrowing = 0.8;
constexpr double kInlier_m = 0.02;
constexpr double kLeastOnPlanes = 0.2, kLeastInliers = 0.5;
constexpr std::size_t kLeastPairs = 150;
constexpr double kSigma_m = 0.003, kCorrelation = 10;

struct AlignSums {
  Matrix6d information = Matrix6d::Identity() * 1e-6;
  Vector6d gradient = Vector6d::Zero();
  std::size_t pairs = 0, inliers = 0, on_planes = 0, points = 0;
};

/// The plane that the point (sensor frame as learnt) projects onto; nullptr where none is remembered.
const BackgroundCell* plane_at(const BackgroundMap& map, const Eigen::Vector3d& point) {
  if (point.z() < 0.1) return nullptr;
  const CameraModel& grid = map.grid();
  const Eigen::Vector2d pixel = grid.project(point);
  const auto x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (!pixel.allFinite() || x < 0 || y < 0 || x >= grid.width || y >= grid.height) return nullptr;
  const BackgroundCell& cell = map.cells()[static_cast<std::size_t>(y * grid.width + x)];
  return cell.has_plane() ? &cell : nullptr;
}

AlignSums collect(const BackgroundMap& map, std::span<const float> depth_m,
                  std::span<const std::uint8_t> robot, const Pose& T_learnt_now, double kernel_m) {
  AlignSums sums;
  const CameraModel& grid = map.grid();
  for (int y = 0; y < grid.height; y += kStep_cells) {
    for (int x = 0; x < grid.width; x += kStep_cells) {
      const auto i = static_cast<std::size_t>(y * grid.width + x);
      if (depth_m[i] <= 0 || (!robot.empty() && robot[i] != 0)) continue;
      ++sums.points;
      const Eigen::Vector3d p = T_learnt_now * (static_cast<double>(depth_m[i]) * map.rays().at(x, y));
      const BackgroundCell* plane = plane_at(map, p);
      if (plane == nullptr) continue;
      ++sums.on_planes;
      const Eigen::Vector3d m = plane->normal_per_m.cast<double>();
      const double scale = 1 / m.norm(), residual = (m.dot(p) - 1) * scale, off = residual / kernel_m;
      if (std::abs(residual) < kInlier_m) ++sums.inliers;
      if (std::abs(off) >= 1) continue;
      Vector6d slope;
      slope << p.cross(m) * scale, m * scale;
      const double weight = (1 - off * off) * (1 - off * off);
      sums.information.selfadjointView<Eigen::Lower>().rankUpdate(slope, weight);
      sums.gradient -= weight * residual * slope;
      ++sums.pairs;
    }
  }
  sums.information = sums.information.selfadjointView<Eigen::Lower>();
  return sums;
}

}  // namespace

std::optional<BackgroundAlignment> align_background(const BackgroundMap& map, std::span<const float> depth_m,
                                                    std::span<const std::uint8_t> robot, const Pose& start) {
  BackgroundAlignment found;
  found.T_learnt_now = start;
  double kernel_m = kFirstKernel_m;
  for (int i = 0; i < kAlignSteps; ++i) {
    const AlignSums sums = collect(map, depth_m, robot, found.T_learnt_now, kernel_m);
    if (sums.pairs < kLeastPairs) return std::nullopt;
    const Eigen::LDLT<Matrix6d> solver(sums.information);
    const Vector6d step = solver.solve(sums.gradient);
    Pose move = Pose::Identity();
    move.linear() = exp_so3(step.head<3>());
    move.translation() = step.tail<3>();
    found.T_learnt_now = move * found.T_learnt_now;
    found.covariance = kSigma_m * kSigma_m * kCorrelation * solver.solve(Matrix6d::Identity());
    kernel_m = std::max(kLastKernel_m, kNarrowing * kernel_m);
  }
  const AlignSums last = collect(map, depth_m, robot, found.T_learnt_now, kLastKernel_m);
  if (last.pairs < kLeastPairs) return std::nullopt;
  found.on_planes = static_cast<double>(last.on_planes) / static_cast<double>(last.points);
  found.inliers = static_cast<double>(last.inliers) / static_cast<double>(last.on_planes);
  const AlignSums before = collect(map, depth_m, robot, Pose::Identity(), kLastKernel_m);
  found.in_place = static_cast<double>(before.inliers) / static_cast<double>(before.points);
  if (found.on_planes < kLeastOnPlanes || found.inliers < kLeastInliers) return std::nullopt;
  return found;
}

}  // namespace calibrd
