// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/window_support.hpp"

#include <Eigen/Cholesky>
#include <limits>

namespace calibrd {
namespace {

/// The test takes the tolerance off whole, this adds it to the noise: where there is little of that, half of
/// it is nearer to the same.
constexpr double kTolerated = 0.5;

TileSums window_at(const TiledFit& fit, std::size_t column, std::size_t row) {
  TileSums sums;
  for (std::size_t r = row; r < row + kWindowTiles; ++r) {
    for (std::size_t c = column; c < column + kWindowTiles; ++c) {
      const TileSums& tile = fit.tiles[r * kTilesPerRow + c];
      sums.information += tile.information;
      sums.gradient += tile.gradient;
    }
  }
  return sums;
}

}  // namespace

double squares_beyond_tolerance(const Vector6d& shift, const Matrix6d& covariance) {
  return shift.dot((covariance + kTolerated * kTolerated * Matrix6d::Identity()).ldlt().solve(shift));
}

std::optional<WindowLeftOut> least_shift_without_a_window(const TiledFit& fit, const Matrix6d& move) {
  TileSums all;
  for (const TileSums& tile : fit.tiles) {
    all.information += tile.information;
    all.gradient += tile.gradient;
  }
  std::optional<WindowLeftOut> best;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t columns = kTilesPerRow, rows = fit.tiles.size() / columns;
  for (std::size_t row = 0; row + kWindowTiles <= rows; ++row) {
    for (std::size_t column = 0; column + kWindowTiles <= columns; ++column) {
      const TileSums window = window_at(fit, column, row);
      if (window.information.isZero(0)) continue;
      BackgroundMatrix information = fit.worth * (all.information - window.information);
      information.diagonal() += fit.information;
      const Eigen::LDLT<BackgroundMatrix> solver(information);
      const BackgroundVector solution = fit.at + solver.solve(fit.worth * (all.gradient - window.gradient) -
                                                              fit.information.cwiseProduct(fit.at));
      const BackgroundMatrix covariance = solver.solve(BackgroundMatrix::Identity());
      const double squares = squares_beyond_tolerance(
          move * solution.head<6>(), move * covariance.topLeftCorner<6, 6>() * move.transpose());
      if (squares >= least) continue;
      least = squares;
      best = WindowLeftOut{solution, window.information, column, row};
    }
  }
  return best;
}

}  // namespace calibrd
