// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/rotation_grid.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace calibrd {

std::vector<Eigen::Matrix3d> even_rotations(std::size_t count) {
  constexpr double kPhi = std::numbers::sqrt2;
  constexpr double kPsi = 1.533751168755204288118041;  // root of psi⁴ = psi + 4, as in the paper
  std::vector<Eigen::Matrix3d> rotations;
  rotations.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double s = static_cast<double>(i) + 0.5;
    const double t = s / static_cast<double>(count);
    const double alpha = 2 * std::numbers::pi * s / kPhi, beta = 2 * std::numbers::pi * s / kPsi;
    const double r = std::sqrt(t), R = std::sqrt(1 - t);
    rotations.push_back(
        Eigen::Quaterniond(R * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), R * std::sin(beta))
            .normalized()
            .toRotationMatrix());
  }
  return rotations;
}

}  // namespace calibrd
