// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/coarse_align.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "core/registration/cloud_tree.hpp"

namespace calibrd {
namespace {

Eigen::AlignedBox3d bounds_in_sensor(const VirtualMeasurement& prediction, const PixelRays& rays) {
  Eigen::AlignedBox3d box;
  for (int y = 0; y < prediction.height; ++y) {
    for (int x = 0; x < prediction.width; ++x) {
      const float z = prediction.depth_m[static_cast<std::size_t>(y * prediction.width + x)];
      if (z > 0) box.extend(z * rays.at(x, y));
    }
  }
  return box;
}

/// The measured points of one view near the robot, sensor frame.
CloudTree measured_tree(const RegistrationView& view, const CameraModel& camera, Eigen::AlignedBox3d region,
                        const CoarseSettings& settings) {
  constexpr int kStride = 3;
  region.min().array() -= settings.crop_margin_m;
  region.max().array() += settings.crop_margin_m;
  std::vector<Eigen::Vector3f> points;
  for (int y = 0; y < camera.height; y += kStride) {
    for (int x = 0; x < camera.width; x += kStride) {
      const float z = view.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                                   static_cast<std::size_t>(x)];
      if (z < region.min().z() || z > region.max().z() || z <= 0) continue;
      const Eigen::Vector3d p = z * view.rays->at(x, y);
      if (region.contains(p)) points.push_back(p.cast<float>());
    }
  }
  return CloudTree(std::move(points));
}

struct Sums {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/// Point-to-plane sums of one view at one pose.
Sums pull_of(const VirtualMeasurement& prediction, const PixelRays& rays, const CloudTree& measured,
             const Pose& T_base_sensor, double kernel_m) {
  Sums sums;
  const Eigen::Matrix3d R = T_base_sensor.linear();
  for (int y = 0; y < prediction.height; ++y) {
    for (int x = 0; x < prediction.width; ++x) {
      const auto i = static_cast<std::size_t>(y * prediction.width + x);
      if (prediction.link[i] < 0) continue;
      const Eigen::Vector3d q = prediction.depth_m[i] * rays.at(x, y);
      const auto neighbour = measured.nearest(q);
      if (!neighbour) continue;
      const double distance = neighbour->distance_m / kernel_m;
      if (distance >= 1) continue;
      const double weight = (1 - distance * distance) * (1 - distance * distance);
      const Eigen::Vector3d n = prediction.normal[i].cast<double>();
      const double residual = n.dot(neighbour->point - q);
      const Eigen::Vector3d n_base = R * n, u_base = R * q;
      Vector6d jacobian;
      jacobian << -u_base.cross(n_base), -n_base;
      sums.information.noalias() += weight * jacobian * jacobian.transpose();
      sums.gradient += weight * residual * jacobian;
    }
  }
  return sums;
}

}  // namespace

Pose coarse_align(std::span<const RegistrationView> views, const CameraModel& camera, const Pose& guess,
                  const CoarseSettings& settings) {
  const CameraModel small = camera.binned(settings.reduction);
  const PixelRays rays(small);
  std::vector<std::optional<CloudTree>> measured(views.size());
  std::vector<VirtualMeasurement> predictions(views.size());
  std::vector<Sums> sums(views.size());
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    views[v].cell.measure(small, guess, predictions[v]);
    measured[v].emplace(measured_tree(views[v], camera, bounds_in_sensor(predictions[v], rays), settings));
  });

  Pose pose = guess;
  const double shrink =
      std::pow(settings.end_kernel_m / settings.start_kernel_m, 1.0 / (settings.iterations - 1));
  double kernel_m = settings.start_kernel_m;
  for (int iteration = 0; iteration < settings.iterations; ++iteration, kernel_m *= shrink) {
    tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
      views[v].cell.measure(small, pose, predictions[v]);
      sums[v] = pull_of(predictions[v], rays, *measured[v], pose, kernel_m);
    });
    Sums total;
    for (const Sums& s : sums) {
      total.information += s.information;
      total.gradient += s.gradient;
    }
    if (total.information.trace() <= 0) break;
    const Matrix6d damped = total.information + 1e-6 * total.information.trace() * Matrix6d::Identity();
    pose = perturbed(pose, damped.ldlt().solve(total.gradient));
  }
  return pose;
}

}  // namespace calibrd
