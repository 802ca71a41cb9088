// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/camera.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace calibrd::sim {

Camera::Camera(const CameraParameters& parameters)
    : p_(parameters), distorted_(std::any_of(p_.distortion.begin(), p_.distortion.end(), [](double k) { return k != 0; })) {}

Eigen::Vector2d Camera::distorted(double x, double y) const {
  const auto& [k1, k2, p1, p2, k3] = p_.distortion;
  const double xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  return {x * radial + 2 * p1 * xy + p2 * (r2 + 2 * xx), y * radial + p1 * (r2 + 2 * yy) + 2 * p2 * xy};
}

Eigen::Vector2d Camera::pixel(const Eigen::Vector2d& n) const {
  const Eigen::Vector2d d = distorted_ ? distorted(n.x(), n.y()) : n;
  return {p_.cx + p_.fx * d.x(), p_.cy + p_.fy * d.y()};
}

Eigen::Vector2d Camera::undistorted(double u, double v) const {
  const Eigen::Vector2d target((u - p_.cx) / p_.fx, (v - p_.cy) / p_.fy);
  if (!distorted_) return target;
  // Newton with a differenced Jacobian: slow and plain, for it is done once per sample of the image.
  constexpr double kStep = 1e-6, kExact = 1e-13;
  Eigen::Vector2d x = target;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d miss = distorted(x.x(), x.y()) - target;
    if (miss.cwiseAbs().maxCoeff() < kExact) break;
    Eigen::Matrix2d slope;
    slope << (distorted(x.x() + kStep, x.y()) - distorted(x.x() - kStep, x.y())) / (2 * kStep),
        (distorted(x.x(), x.y() + kStep) - distorted(x.x(), x.y() - kStep)) / (2 * kStep);
    x -= slope.inverse() * miss;
  }
  return x;
}

}  // namespace calibrd::sim
