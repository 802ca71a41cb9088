// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "core/geometry/pose.hpp"

namespace calibrd {

/// perturbed()'s six in sensor axes, range offset.
constexpr int kBackgroundParameters = 7;
using BackgroundVector = Eigen::Matrix<double, kBackgroundParameters, 1>;
using BackgroundMatrix = Eigen::Matrix<double, kBackgroundParameters, kBackgroundParameters>;

/// Tiles, square ones, to a row of the image, whatever its size, and tiles to each side of a window.
constexpr int kTilesPerRow = 8;
constexpr std::size_t kWindowTiles = 3;

/// Normal equations of the cells of one tile.
struct TileSums {
  BackgroundMatrix information = BackgroundMatrix::Zero();
  BackgroundVector gradient = BackgroundVector::Zero();
};

/// A linear least-squares fit whose sums are kept by tiles, row-major.
struct TiledFit {
  std::span<const TileSums> tiles;                          ///< rows of kTilesPerRow
  BackgroundVector at = BackgroundVector::Zero();           ///< what the sums are linearized about
  BackgroundVector information = BackgroundVector::Zero();  ///< known before: diagonal, about 0
  double worth = 1;                                         ///< of the sums, against `information`
};

/// The fit without one window.
struct WindowLeftOut {
  BackgroundVector solution = BackgroundVector::Zero();
  BackgroundMatrix left_out = BackgroundMatrix::Zero();  ///< information of the window, not weighted
  std::size_t column = 0, row = 0;                       ///< of its first tile
};

/// A box that is pushed moves what it shows as the sensor's move would, and where nothing else tells of that
/// direction the two are one. Of the fits that leave out one window of the image each (an object is in one),
/// the one that is least of a shift: what of a shift is left whatever single object moved. `move` maps the
/// pose parameters to the shift, in units of what is tolerated. Nothing: no window holds anything.
std::optional<WindowLeftOut> least_shift_without_a_window(const TiledFit& fit, const Matrix6d& move);

/// Squares of the shift against its covariance with what is tolerated (1 in all six) on top.
double squares_beyond_tolerance(const Vector6d& shift, const Matrix6d& covariance);

}  // namespace calibrd
