// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/expected_views.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/registration/priors.hpp"
#include "core/registration/range_residuals.hpp"
#include "core/registration/reported_joints.hpp"

namespace calibrd {
namespace {

constexpr double kUsualPeriod_m = 0.6;  // of the range's periodic term, 16 to 120 MHz modulation
constexpr int kCoarseWidth = 128;
/// Neighbouring pixels err alike: so many of them say what one would.
constexpr double kCorrelation = 10;
/// What range would leave open the outline may have fixed: nothing counts as known worse than to this many of
/// the sigmas that were found.
constexpr double kLooseness = 3;

/// The coarse grid with the fine one's focal length: a pixel's noise depends on its true width.
CameraModel with_fine_pixels(CameraModel coarse, const CameraModel& camera) {
  coarse.fx = camera.fx;
  coarse.fy = camera.fy;
  return coarse;
}

ParameterMatrix prior_information() {
  ParameterVector sigmas = prior_sigmas({}, {.bias = true, .zeros = true, .period_m = kUsualPeriod_m});
  sigmas.head<6>().setConstant(1e3);  // nothing is known of the pose, but what is seen must be inverted
  return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
}

Matrix6d square_root(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
  const Vector6d roots = solver.eigenvalues().cwiseMax(1e-18).cwiseSqrt();
  return solver.eigenvectors() * roots.asDiagonal() * solver.eigenvectors().transpose();
}

RegistrationView empty_view(const VirtualCell& cell, const std::shared_ptr<const PixelRays>& rays) {
  return {cell, {}, JointAxes(cell.robot(), cell.link_poses()), {}, {}, 0, rays};
}

}  // namespace

ExpectedViews::ExpectedViews(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor,
                             const Matrix6d& covariance, std::span<const std::vector<double>> seen_postures,
                             const PlanningSettings& settings)
    : settings_(settings),
      reduction_(std::max(1, camera.width / kCoarseWidth)),
      least_pixels_(static_cast<std::size_t>(settings.min_robot_share * camera.width * camera.height)),
      coarse_(camera.binned(reduction_)),
      noise_camera_(with_fine_pixels(coarse_, camera)),
      T_base_sensor_(T_base_sensor),
      predictions_(seen_postures.size() + 1),
      information_(prior_information()) {
  const auto rays = cell.pixel_rays(coarse_);
  for (std::size_t i = 0; i <= seen_postures.size(); ++i) views_.push_back(empty_view(cell, rays));
  for (std::size_t i = 0; i < seen_postures.size(); ++i) information_ += see(i, seen_postures[i]).information;
  compare_with_known(covariance);
}

/// The expectation is trusted in how it changes, not in its size: what the calibration found of its own
/// uncertainty (noise, correlation, what hides the robot) is carried over. Without postures the covariance
/// is all that is known.
void ExpectedViews::compare_with_known(const Matrix6d& covariance) {
  const bool any_seen = views_.size() > 1;
  const Matrix6d known = covariance.ldlt().solve(Matrix6d::Identity());
  information_.topLeftCorner<6, 6>() += known / (any_seen ? kLooseness * kLooseness : 1);
  correction_.setIdentity();
  if (!any_seen) return;
  const Matrix6d expected = published(information_, views_.size() - 1);
  correction_ = square_root(covariance) * square_root(expected).inverse();
}

ExpectedViews::Seen ExpectedViews::see(std::size_t slot, const std::vector<double>& posture) {
  RegistrationView& view = views_[slot];
  VirtualMeasurement& prediction = predictions_[slot];
  view.reported_joints = posture;
  view.apply_zeros(Eigen::Matrix<double, kMaxJointZeros, 1>::Zero());
  view.cell.measure(coarse_, T_base_sensor_, prediction);
  view.depth_m = prediction.depth_m;
  for (float& depth_m : view.depth_m)
    if (depth_m > settings_.max_range_m) depth_m = 0;
  NormalEquations equations;
  RangeTally tally;
  add_range_residuals(view, prediction, noise_camera_, T_base_sensor_, {}, {}, equations, tally);
  const auto pixels = static_cast<std::size_t>(reduction_ * reduction_);
  const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
  return {static_cast<double>(pixels) / kCorrelation * information, tally.measured * pixels};
}

/// From joint zeros to the pose that is right for the joints as reported, which is what is published.
ExpectedViews::PoseByZeros ExpectedViews::by_zeros(std::size_t views) const {
  return reported_joints_map(std::span(views_).first(views), std::span(predictions_).first(views), coarse_,
                             T_base_sensor_);
}

Matrix6d ExpectedViews::published(const ParameterMatrix& information, std::size_t views) const {
  Eigen::Matrix<double, 6, kParameters> map = Eigen::Matrix<double, 6, kParameters>::Zero();
  map.leftCols<6>().setIdentity();
  map.rightCols<kMaxJointZeros>() = by_zeros(views);
  return map * information.ldlt().solve(map.transpose());
}

/// Where no posture is known to have been seen, what is known is of the published pose, not of the pose and
/// the zeros that it came from: the new information is put in its terms.
Matrix6d ExpectedViews::after_one(const ParameterMatrix& seen) const {
  ParameterMatrix to_published = ParameterMatrix::Identity();
  to_published.topRightCorner<6, kMaxJointZeros>() = -by_zeros(1);
  const ParameterMatrix information = information_ + to_published.transpose() * seen * to_published;
  return information.ldlt().solve(ParameterMatrix::Identity()).topLeftCorner<6, 6>();
}

std::optional<ExpectedViews::Expectation> ExpectedViews::after(const std::vector<double>& posture) {
  const Seen seen = see(views_.size() - 1, posture);
  if (seen.robot_pixels < least_pixels_) return std::nullopt;
  if (views_.size() == 1) return Expectation{after_one(seen.information), seen.robot_pixels};
  const Matrix6d expected = published(information_ + seen.information, views_.size());
  return Expectation{correction_ * expected * correction_.transpose(), seen.robot_pixels};
}

}  // namespace calibrd
