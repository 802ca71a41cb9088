// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera_model.hpp"

#include <Eigen/LU>

namespace calibrd {
namespace {

/// Distorted normalised coordinates of ideal ones (OpenCV's model).
Eigen::Vector2d distort(const std::array<double, 5>& d, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = d;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Matrix2d distort_jacobian(const std::array<double, 5>& d, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = d;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // d radial / d x = slope * x
  Eigen::Matrix2d j;
  j(0, 0) = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x;
  j(0, 1) = slope * x * y + 2 * p1 * x + 2 * p2 * y;
  j(1, 0) = slope * x * y + 2 * p1 * x + 2 * p2 * y;
  j(1, 1) = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x;
  return j;
}

constexpr int kUndistortIterations = 12;

}  // namespace

Eigen::Vector3d CameraModel::ray(double u, double v) const {
  const Eigen::Vector2d seen((u - cx) / fx, (v - cy) / fy);
  if (!is_distorted()) return {seen.x(), seen.y(), 1.0};
  Eigen::Vector2d ideal = seen;
  for (int i = 0; i < kUndistortIterations; ++i) {
    const Eigen::Vector2d error = distort(distortion, ideal.x(), ideal.y()) - seen;
    if (error.squaredNorm() < 1e-24) break;
    ideal -= distort_jacobian(distortion, ideal.x(), ideal.y()).inverse() * error;
  }
  return {ideal.x(), ideal.y(), 1.0};
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& p) const {
  const Eigen::Vector2d d = distort(distortion, p.x() / p.z(), p.y() / p.z());
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Matrix<double, 2, 3> CameraModel::projection_jacobian(const Eigen::Vector3d& p) const {
  const double x = p.x() / p.z(), y = p.y() / p.z();
  Eigen::Matrix<double, 2, 3> normalised;
  normalised << 1, 0, -x, 0, 1, -y;
  normalised /= p.z();
  return Eigen::Vector2d(fx, fy).asDiagonal() * distort_jacobian(distortion, x, y) * normalised;
}

CameraModel CameraModel::binned(int side) const {
  CameraModel coarse = *this;
  coarse.width /= side;
  coarse.height /= side;
  coarse.fx /= side;
  coarse.fy /= side;
  coarse.cx = (cx + 0.5) / side - 0.5;
  coarse.cy = (cy + 0.5) / side - 0.5;
  return coarse;
}

CameraModel CameraModel::subsampled(int step) const {
  CameraModel sparse = *this;
  sparse.width = (width + step - 1) / step;
  sparse.height = (height + step - 1) / step;
  sparse.fx /= step;
  sparse.fy /= step;
  sparse.cx /= step;
  sparse.cy /= step;
  return sparse;
}

}  // namespace calibrd
