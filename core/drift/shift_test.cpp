// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_test.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kAllowance = 1;  // standard deviations: half of what it is most sensitive to
/// One frame counts no more than this, so that no single one alarms.
constexpr double kMostPerFrame = 4;
constexpr double kNewest = 0.25;  // weight of a frame in the running mean
constexpr double kSecondsPerYear = 365.25 * 86400;
/// Uncertainty that does not average out from frame to frame (a tool's shadow, a cable that sways), m and
/// rad.
constexpr double kFloor_m = 1e-4, kFloor_rad = 1e-4;

double mean_run_length(double allowance, double threshold) {
  const double reach = 2 * allowance * (threshold + 1.166);
  return (std::exp(reach) - reach - 1) / (2 * allowance * allowance);
}

}  // namespace

double cusum_threshold(double allowance, double run_length) {
  double low = 0, high = 100;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_run_length(allowance, middle) < run_length ? low : high) = middle;
  }
  return high;
}

ShiftTest::ShiftTest(const ShiftTestSettings& settings)
    : settings_(settings),
      threshold_(
          cusum_threshold(kAllowance, settings.rate_hz * kSecondsPerYear / settings.false_alarms_per_year)) {}

void ShiftTest::reset() { *this = ShiftTest(settings_); }

Vector6d ShiftTest::mean() const {
  Vector6d mean = scaled_mean_;
  mean.head<3>() *= settings_.tolerance_rad;
  mean.tail<3>() *= settings_.tolerance_m;
  return mean;
}

void ShiftTest::add(const Vector6d& turn_shift, const Matrix6d& covariance, double common_share) {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(1 / settings_.tolerance_rad),
      Eigen::Vector3d::Constant(1 / settings_.tolerance_m);
  Matrix6d scaled = covariance;
  scaled.diagonal().head<3>().array() += kFloor_rad * kFloor_rad;
  scaled.diagonal().tail<3>().array() += kFloor_m * kFloor_m;
  scaled = unit.asDiagonal() * scaled * unit.asDiagonal();
  const Vector6d shift = unit.cwiseProduct(turn_shift);
  if (frames_ > 0) {
    // The matched filter for what the frames before have shown.
    const Vector6d weight = scaled.ldlt().solve(scaled_mean_);
    // Turn and shift may each be off by the tolerance at once.
    const double tolerated = weight.head<3>().norm() + weight.tail<3>().norm();
    const double excess = (weight.dot(shift) - tolerated) / std::sqrt(weight.dot(scaled * weight)) -
                          kCommonSigmas * std::sqrt(common_share);
    const double step = std::isfinite(excess) ? std::min(excess, kMostPerFrame) - kAllowance : -kAllowance;
    statistic_ = std::max(0.0, statistic_ + step);
    run_length_ = statistic_ > 0 ? run_length_ + 1 : 0;
  }
  scaled_mean_ = frames_ == 0 ? shift : Vector6d(scaled_mean_ + kNewest * (shift - scaled_mean_));
  ++frames_;
}

}  // namespace calibrd
