// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cross_check/range_error.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kOffsetError_m = 0.002, kScaleError = 2e-3;
/// The "wiggling" of time-of-flight sensors, over which depth it changes (docs/simulator.md has sources), and
/// what is left of a knot when its neighbours are known.
constexpr double kWiggle_m = 0.002, kWiggleLength_m = 0.25, kRough_m = 2e-4;
constexpr double kStep_m = 0.2;
constexpr Eigen::Index kMostKnots = 24;

}  // namespace

RangeError::RangeError(double least_m, double most_m, double known_at_m)
    : least_m_(least_m),
      known_at_m_(known_at_m),
      step_m_(std::max(kStep_m, (most_m - least_m) / static_cast<double>(kMostKnots - 1))),
      knots_(std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::ceil((most_m - least_m) / step_m_)) + 1,
                                      2, kMostKnots)) {}

RangeError::Place RangeError::at(double depth_m) const {
  const double at = std::clamp((depth_m - least_m_) / step_m_, 0.0, static_cast<double>(knots_ - 1));
  const auto index = std::min(static_cast<Eigen::Index>(at), knots_ - 2);
  return {index, at - static_cast<double>(index)};
}

Eigen::MatrixXd RangeError::precision() const {
  Eigen::MatrixXd covariance(knots_, knots_);
  for (Eigen::Index i = 0; i < knots_; ++i)
    for (Eigen::Index j = 0; j < knots_; ++j) {
      const double a = least_m_ + step_m_ * static_cast<double>(i),
                   b = least_m_ + step_m_ * static_cast<double>(j), apart = (a - b) / kWiggleLength_m;
      covariance(i, j) = kOffsetError_m * kOffsetError_m +
                         kScaleError * kScaleError * (a - known_at_m_) * (b - known_at_m_) +
                         kWiggle_m * kWiggle_m * std::exp(-0.5 * apart * apart);
    }
  covariance.diagonal().array() += kRough_m * kRough_m;
  return covariance.llt().solve(Eigen::MatrixXd::Identity(knots_, knots_));
}

}  // namespace calibrd
