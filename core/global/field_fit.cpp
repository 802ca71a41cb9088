// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/field_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace calibrd {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

struct Sums {
  Matrix6f information = Matrix6f::Zero();
  Vector6f gradient = Vector6f::Zero();
  float cost = 0;
  std::size_t count = 0;
};

Sums sum_over(std::span<const PostureEvidence> postures, const Pose& T_base_sensor, double kernel_m,
              std::size_t stride) {
  const Eigen::Matrix3f R = T_base_sensor.linear().cast<float>();
  const Eigen::Vector3f t = T_base_sensor.translation().cast<float>();
  const auto squared_kernel = static_cast<float>(kernel_m * kernel_m);
  Sums sums;
  for (const PostureEvidence& posture : postures) {
    for (std::size_t i = 0; i < posture.points_sensor.size(); i += stride) {
      const Eigen::Vector3f arm = R * posture.points_sensor[i];
      const DistanceField::Value field = posture.surface_base->at(arm + t);
      const float squared = field.distance_m * field.distance_m;
      const float share = squared_kernel / (squared_kernel + squared);  // Geman-McClure
      Vector6f jacobian;
      const Eigen::Vector3f& g = field.gradient;  // written out: GCC 12 warns of Eigen's vectorised cross()
      jacobian << arm.y() * g.z() - arm.z() * g.y(), arm.z() * g.x() - arm.x() * g.z(),
          arm.x() * g.y() - arm.y() * g.x(), g;
      sums.information.noalias() += share * share * jacobian * jacobian.transpose();
      sums.gradient -= share * share * field.distance_m * jacobian;
      sums.cost += 1 - share;
      ++sums.count;
    }
  }
  return sums;
}

}  // namespace

FieldFit fit_to_fields(std::span<const PostureEvidence> postures, const Pose& start,
                       const FieldFitSettings& settings) {
  FieldFit fit{start, 1};
  const double shrink =
      std::pow(settings.end_kernel_m / settings.start_kernel_m, 1.0 / std::max(1, settings.iterations - 1));
  double kernel_m = settings.start_kernel_m;
  for (int i = 0; i < settings.iterations; ++i, kernel_m *= shrink) {
    const Sums sums = sum_over(postures, fit.T_base_sensor, kernel_m, settings.stride);
    if (sums.count == 0) return fit;
    const Matrix6f damped =
        sums.information + (1e-3F * sums.information.trace() + 1e-6F) * Matrix6f::Identity();
    fit.T_base_sensor =
        perturbed(fit.T_base_sensor, damped.ldlt().solve(sums.gradient).cast<double>().eval());
  }
  const Sums last = sum_over(postures, fit.T_base_sensor, settings.end_kernel_m, settings.stride);
  fit.cost = last.cost / static_cast<double>(last.count);
  return fit;
}

}  // namespace calibrd
