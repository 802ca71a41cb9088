// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/canonical_rotation.hpp"

#include <cmath>

namespace calibrd {
namespace {

constexpr double kZero = 1e-12;

bool points_back(const Eigen::Vector3d& axis) {
  for (const double component : axis)
    if (std::abs(component) > kZero) return component < 0;
  return false;
}

}  // namespace

Eigen::Quaterniond canonical_quaternion(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (std::abs(q.w()) <= kZero) q.w() = 0;
  if (q.w() < 0 || (q.w() == 0 && points_back(q.vec()))) q.coeffs() *= -1;
  q.coeffs().array() += 0.0;  // no minus zero
  return q;
}

Eigen::Vector3d canonical_rotation_vector(const Eigen::Matrix3d& rotation) {
  const auto q = canonical_quaternion(rotation);
  const double sine = q.vec().norm();
  if (sine == 0) return Eigen::Vector3d::Zero();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace calibrd
