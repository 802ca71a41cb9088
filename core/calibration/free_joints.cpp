// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/free_joints.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/registration/range_residuals.hpp"

namespace calibrd {
namespace {

using Joints = Eigen::Matrix<double, kMaxJointZeros, 1>;

constexpr int kIterations = 10;
constexpr double kStartKernel_m = 0.1, kEndKernel_m = 0.015;
constexpr double kPrior_rad = 0.08;
/// Neighbouring pixels repeat each other: the sums count them this many times too often against the prior.
constexpr double kRepetition = 30;

struct Sums {
  std::vector<NormalEquations> views;
  std::vector<RangeTally> tallies;

  /// Share of the pixels near the robot that lie within the kernel.
  double agreeing() const {
    RangeTally all;
    for (const RangeTally& tally : tallies) all.merge(tally);
    return all.measured > 0 ? static_cast<double>(all.agreeing) / static_cast<double>(all.measured) : 0;
  }
};

Sums sums_of(std::span<const RegistrationView> views, const CameraModel& camera, const Pose& T_base_sensor,
             double kernel_m) {
  RangeSettings settings;
  settings.kernel_m = kernel_m;
  settings.stride = 3;
  Sums sums{std::vector<NormalEquations>(views.size()), std::vector<RangeTally>(views.size())};
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    VirtualMeasurement prediction;
    views[v].cell.measure(camera, T_base_sensor, prediction);
    add_range_residuals(views[v], prediction, camera, T_base_sensor, {}, settings, sums.views[v],
                        sums.tallies[v]);
  });
  return sums;
}

/// One step of all: the pose is common, the joints are each view's own.
Eigen::VectorXd step_of(const std::vector<NormalEquations>& sums, const std::vector<Joints>& corrections) {
  const auto joint_row = [](std::size_t v) { return 6 + static_cast<Eigen::Index>(v) * kMaxJointZeros; };
  const Eigen::Index size = joint_row(sums.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const ParameterMatrix own =
        ParameterMatrix(sums[v].information().selfadjointView<Eigen::Lower>()) / kRepetition;
    const Eigen::Index row = joint_row(v);
    information.topLeftCorner<6, 6>() += own.topLeftCorner<6, 6>();
    information.block<6, kMaxJointZeros>(0, row) = own.topRightCorner<6, kMaxJointZeros>();
    information.block<kMaxJointZeros, 6>(row, 0) = own.bottomLeftCorner<kMaxJointZeros, 6>();
    information.block<kMaxJointZeros, kMaxJointZeros>(row, row) =
        own.bottomRightCorner<kMaxJointZeros, kMaxJointZeros>();
    gradient.head<6>() += sums[v].gradient().head<6>() / kRepetition;
    gradient.segment<kMaxJointZeros>(row) =
        sums[v].gradient().tail<kMaxJointZeros>() / kRepetition - corrections[v] / (kPrior_rad * kPrior_rad);
    information.diagonal().segment<kMaxJointZeros>(row).array() += 1 / (kPrior_rad * kPrior_rad);
  }
  information.diagonal().head<6>().array() += 1e-6 * information.diagonal().head<6>().maxCoeff() + 1e-9;
  return information.ldlt().solve(gradient);
}

}  // namespace

FreeJointsFit fit_free_joints(std::span<RegistrationView> views, const CameraModel& camera,
                              const Pose& start) {
  FreeJointsFit fit;
  fit.T_base_sensor = start;
  fit.agreeing_before = sums_of(views, camera, start, kEndKernel_m).agreeing();
  std::vector<Joints> corrections(views.size(), Joints::Zero());
  const double shrink = std::pow(kEndKernel_m / kStartKernel_m, 1.0 / (kIterations - 1));
  double kernel_m = kStartKernel_m;
  for (int iteration = 0; iteration < kIterations; ++iteration, kernel_m *= shrink) {
    const Eigen::VectorXd step =
        step_of(sums_of(views, camera, fit.T_base_sensor, kernel_m).views, corrections);
    fit.T_base_sensor = perturbed(fit.T_base_sensor, step.head<6>());
    for (std::size_t v = 0; v < views.size(); ++v) {
      corrections[v] += step.segment<kMaxJointZeros>(6 + static_cast<Eigen::Index>(v) * kMaxJointZeros);
      views[v].apply_zeros(corrections[v]);
    }
  }
  fit.agreeing_after = sums_of(views, camera, fit.T_base_sensor, kEndKernel_m).agreeing();
  Joints mean = Joints::Zero(), squares = Joints::Zero();
  for (const Joints& correction : corrections) {
    mean += correction / static_cast<double>(corrections.size());
    squares += correction.cwiseAbs2() / static_cast<double>(corrections.size());
    fit.largest_rad = std::max(fit.largest_rad, correction.cwiseAbs().maxCoeff());
  }
  fit.spread_rad = std::sqrt((squares - mean.cwiseAbs2()).cwiseMax(0).maxCoeff());
  return fit;
}

}  // namespace calibrd
