// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Where DriftWatch looks for a background that is not, pixel by pixel, where it was.

#include <Eigen/Eigenvalues>

#include "core/drift/drift_watch.hpp"

namespace calibrd {
namespace {

constexpr double kMuch = 0.35, kWhole = 0.9;  // shares of a frame
/// A sensor that has moved sees so much more of the background there than it would, had it not moved. Who
/// stands before the lens hides it from either place.
constexpr double kMoreThanInPlace = 1.5;

}  // namespace

/// An alignment that leaves a direction open may slide along it as far as it likes, and is no evidence.
bool DriftWatch::is_pinned(const BackgroundAlignment& found) const {
  const Matrix6d move = shift_of_point(map_.middle_sensor());
  const Matrix6d covariance = move * found.covariance * move.transpose();
  return worst_sigma(covariance.topLeftCorner<3, 3>()) < kSeenWithin_rad &&
         worst_sigma(covariance.bottomRightCorner<3, 3>()) < kSeenWithin_m;
}

/// All that is seen is the background seen from elsewhere, whatever directions it leaves open.
bool DriftWatch::lies_elsewhere(const BackgroundAlignment& found) const {
  if (found.on_planes < kMuch || found.inliers < kWhole) return false;
  Matrix6d move = shift_of_point(map_.middle_sensor());  // in units of what is known well
  move.topRows<3>() /= kSeenWithin_rad;
  move.bottomRows<3>() /= kSeenWithin_m;
  const Vector6d shift = move * difference(Pose::Identity(), found.T_learnt_now);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(move * found.covariance * move.transpose());
  double square = 0;
  for (Eigen::Index i = 0; i < 6 && axes.eigenvalues()[i] < 1; ++i)
    square += std::pow(axes.eigenvectors().col(i).dot(shift), 2);
  return square > 1;
}

/// The background is not where it was, pixel by pixel: perhaps the sensor sees it from elsewhere.
void DriftWatch::realign(std::span<const std::uint8_t> robot, BackgroundObservation& observation) {
  if (observation.share(CellState::dark) > 0.8) return;
  std::optional<BackgroundAlignment> found;
  if (T_learnt_now_) found = align_background(map_, matcher_.depth_m(), {}, *T_learnt_now_);
  if (!found) found = align_background(map_, matcher_.depth_m(), robot, Pose::Identity());
  if (found && !moved_ && found->on_planes * found->inliers < kMoreThanInPlace * found->in_place)
    found.reset();
  if (!found || !is_pinned(*found)) {
    lies_elsewhere_ = found && lies_elsewhere(*found);
    return T_learnt_now_.reset();
  }
  T_learnt_now_ = found->T_learnt_now;
  const Matrix6d turn = turn_of_axes(T_base_sensor_.linear());
  observation.has_evidence = observation.realigned = true;
  observation.shift = difference(T_base_sensor_, T_base_sensor_ * found->T_learnt_now);
  observation.covariance = turn * found->covariance * turn.transpose();
  observation.supported_shift = observation.shift;
  observation.supported_covariance = observation.covariance;
}

}  // namespace calibrd
