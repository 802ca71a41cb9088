// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/calibration/check_pose.hpp"
#include "core/drift/tile_adder.hpp"
#include "core/registration/linearization.hpp"

namespace calibrd {
namespace {

/// Of a sensor that stands or has moved a little, and of one that has moved far.
constexpr double kNearKernel_m = 0.012, kFarKernel_m = 0.04, kLeastKernel_m = 0.006;
/// The near one will do when of the cells that the far one would look at it leaves out no more than this.
constexpr double kLeftOut = 0.15;
constexpr double kKernelSigmas = 4.7;  // Tukey's biweight: 95 % efficient on normal noise
constexpr double kTypicalSigma_m = 1.6e-3;
constexpr int kMatchSteps = 3;
/// A cell whose depth differs by more is another surface.
constexpr float kOtherSurface_m = 0.02F;
constexpr float kOtherSurfaceSigmas = 8;
/// ... and one that differs by less is the one that is remembered, where the sensor is about where it was.
constexpr float kAsItWas_m = 0.003F;
constexpr float kAsItWasSigmas = 3;
constexpr std::size_t kLeastCells = 150;
/// Below this share of what could be seen the fit may be of anything.
constexpr double kLeastShare = 0.35;
/// No direction is known worse than this before the frame, rad and m: along a plain wall the fit would slide
/// as far as it likes, and leak into what the wall does show. Who has moved farther is searched for.
constexpr double kVague = 0.02, kVagueOffset_m = 0.1;

/// What is left of two large numbers that hardly differ is noise: what a direction tells must be three times
/// what a plain wall would seem to.
constexpr double kSpuriousSafety = 3;
/// Share of a frame's covariance that no other frame averages out: bumps that were no planes, a part that
/// hangs before them. Where the background shows a direction well it is next to nothing.
constexpr double kUnmodelledShare = 0.05;
/// A shift of less squares than this, noise and tolerance taken off, is none that the test would count, and
/// needs no support: two standard deviations.
constexpr double kNoShift = 4;

using Sums = BackgroundMatrix;

BackgroundVector vague_information() {
  BackgroundVector information = BackgroundVector::Constant(1 / (kVague * kVague));
  information[6] = 1 / (kVagueOffset_m * kVagueOffset_m);
  return information;
}

/// Covariance that is left when part of the information is none.
Sums without(const Sums& spurious, const Sums& information, const Sums& vague) {
  const Eigen::SelfAdjointEigenSolver<Sums> solver(information - kSpuriousSafety * spurious);
  const Sums known = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
                     solver.eigenvectors().transpose();
  return (known + vague).ldlt().solve(Sums::Identity());
}

}  // namespace

struct BackgroundMatcher::Fit {
  BackgroundVector at = BackgroundVector::Zero(), solution = BackgroundVector::Zero();
  BackgroundMatrix information = BackgroundMatrix::Zero();
  BackgroundVector gradient = BackgroundVector::Zero();
  BackgroundMatrix covariance = BackgroundMatrix::Zero();
  std::vector<TileSums> tiles;
  double squares = 0, cluster_squares = 0, scatter = 1, common = 0, worth = 1;
  std::size_t used = 0, around = 0;
  bool explains_most() const {
    return static_cast<double>(used) >= (1 - kLeftOut) * static_cast<double>(around);
  }
};

void BackgroundMatcher::sample(const DepthImage& depth) {
  const CameraModel& grid = map_.grid();
  depth_m_.resize(map_.cells().size());
  for (int y = 0; y < grid.height; ++y) {
    const std::uint16_t* raw = depth.raw.data() + depth.index(0, kBackgroundStride * y);
    float* cells = depth_m_.data() + static_cast<std::ptrdiff_t>(y) * grid.width;
    for (int x = 0; x < grid.width; ++x)
      cells[x] = static_cast<float>(raw[kBackgroundStride * x] * depth.scale_m);
  }
}

/// Where hardly a cell is trusted, because something stood before the sensor and it may have been moved
/// meanwhile, all are heard.
void BackgroundMatcher::choose(std::span<const std::uint8_t> robot) {
  speaks_.assign(depth_m_.size(), 0);
  std::size_t measured = 0, trusted = 0;
  for (const Row& row : rows_) {
    if (depth_m_[row.cell] <= 0 || (!robot.empty() && robot[row.cell] != 0)) continue;
    ++measured;
    speaks_[row.cell] = trust_.is_trusted(row.cell) ? 2 : 1;
    if (speaks_[row.cell] == 2) ++trusted;
  }
  const bool are_enough = trusted >= kLeastCells && 2 * trusted >= measured;
  for (std::uint8_t& speaks : speaks_) speaks = speaks > (are_enough ? 1 : 0) ? 1 : 0;
}

void BackgroundMatcher::collect(const BackgroundVector& at, double kernel_m, Fit& fit) {
  fit = {};
  fit.at = at;
  fit.tiles.resize(tiles_);
  whitened_.clear();
  pulls_.assign(clusters_, 0.0);
  TileAdder::Slope start = TileAdder::Slope::Zero();
  start.head<kParameters>() = at.cast<float>();
  {
    TileAdder sums(fit.tiles);
    for (const Row& row : rows_) {
      if (speaks_[row.cell] == 0) continue;
      const float residual = depth_m_[row.cell] - map_.cells()[row.cell].depth_m - row.slope.dot(start);
      if (std::abs(residual) < kFarKernel_m) ++fit.around;
      const double off = residual / kernel_m;
      if (std::abs(off) >= 1) continue;
      const double robust = (1 - off * off) * (1 - off * off), whitened = residual / row.sigma_m;
      sums.begin(row.tile);
      sums.add(row.slope, static_cast<float>(robust) / (row.sigma_m * row.sigma_m), residual);
      const double pull = robust * whitened;
      pulls_[row.cluster] += pull;
      fit.squares += pull * pull;
      whitened_.push_back(static_cast<float>(whitened));
      fit.common += 1 / (1 + static_cast<double>(map_.cells()[row.cell].frames));
      ++fit.used;
    }
  }
  for (const TileSums& sums : fit.tiles) {
    fit.information += sums.information;
    fit.gradient += sums.gradient;
  }
  for (const double pull : pulls_) fit.cluster_squares += pull * pull;
}

/// From afar a post that is gone, a hand's breadth before the wall that was behind it, pulls the whole
/// background along, and does not let go of it again: what stands is looked for first.
BackgroundMatcher::Fit BackgroundMatcher::fit() {
  Fit near = descend(kNearKernel_m);
  if (near.explains_most() && near.used >= kLeastCells) return near;
  Fit far = descend(kFarKernel_m);
  return far.used > near.used ? far : near;
}

BackgroundMatcher::Fit BackgroundMatcher::descend(double first_kernel_m) {
  BackgroundVector at = BackgroundVector::Zero();
  at[6] = last_offset_m_;
  const BackgroundVector vague = vague_information();
  double kernel_m = first_kernel_m;
  Fit fit;
  for (int i = 0; i < kMatchSteps; ++i) {
    collect(at, kernel_m, fit);
    if (fit.used < kLeastCells) return fit;
    fit.scatter = robust_sigma(whitened_);
    const double correlation = std::max(1.0, fit.cluster_squares / fit.squares);
    const double worth = 1 / (fit.scatter * fit.scatter * correlation);
    BackgroundMatrix information = worth * fit.information;
    information.diagonal() += vague;
    const Eigen::LDLT<BackgroundMatrix> solver(information);
    at += solver.solve(worth * fit.gradient - vague.cwiseProduct(at));
    fit.worth = worth;
    kernel_m = std::clamp(kKernelSigmas * fit.scatter * kTypicalSigma_m, kLeastKernel_m, first_kernel_m);
  }
  fit.solution = at;
  const double seen = static_cast<double>(fit.used) / static_cast<double>(rows_.size());
  fit.covariance = without(fit.worth * seen * spurious_, fit.worth * fit.information, vague.asDiagonal());
  return fit;
}

void BackgroundMatcher::find_support(const Fit& fit, const Matrix6d& turn,
                                     BackgroundObservation& observation) const {
  observation.supported_shift = observation.shift;
  observation.supported_covariance = observation.covariance;
  const Matrix6d move = tolerance_.cwiseInverse().asDiagonal() * shift_of_point(map_.middle_sensor());
  const Matrix6d covariance = fit.covariance.topLeftCorner<6, 6>();
  if (squares_beyond_tolerance(move * fit.solution.head<6>(), move * covariance * move.transpose()) <
      kNoShift)
    return;
  const BackgroundVector vague = vague_information();
  const auto least = least_shift_without_a_window({fit.tiles, fit.at, vague, fit.worth}, move);
  if (!least) return;
  const double seen = static_cast<double>(fit.used) / static_cast<double>(rows_.size());
  const Sums left = without(fit.worth * seen * spurious_, fit.worth * (fit.information - least->left_out),
                            vague.asDiagonal());
  const int side = tile_side();
  const auto x = static_cast<int>(least->column) * side, y = static_cast<int>(least->row) * side;
  observation.unsupported = CellWindow{x, y, static_cast<int>(kWindowTiles) * side};
  observation.supported_shift = turn * least->solution.head<6>();
  observation.supported_covariance = turn * left.topLeftCorner<6, 6>() * turn.transpose();
}

void BackgroundMatcher::classify(std::span<const std::uint8_t> robot, const Fit& fit,
                                 BackgroundObservation& observation) {
  states_.assign(map_.cells().size(), CellState::unknown);
  // Not less the shift that was found: a sensor that has moved far is to be searched for, not explained away.
  const bool is_known = std::sqrt(fit.covariance(6, 6)) < BackgroundObservation::kKnownOffset_m;
  const auto offset = is_known ? static_cast<float>(fit.solution[6]) : 0.0F;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const BackgroundCell& known = map_.cells()[i];
    if (known.depth_m <= 0) continue;
    CellState& state = states_[i];
    const float gate = std::max(kOtherSurface_m, kOtherSurfaceSigmas * known.sigma_m);
    if (!robot.empty() && robot[i] != 0)
      state = CellState::robot;
    else if (depth_m_[i] <= 0)
      state = CellState::dark;
    else if (const float change = depth_m_[i] - known.depth_m - offset; change < -gate)
      state = CellState::nearer;
    else
      state = change > gate ? CellState::farther : CellState::same;
  }
  // Edges of the background may fall to either side: only cells with a plane count.
  for (const Row& row : rows_) ++observation.counts[static_cast<std::size_t>(states_[row.cell])];
}

void BackgroundMatcher::follow_trust(const BackgroundObservation& observation) {
  const auto offset = static_cast<float>(observation.known_offset_m());
  for (const Row& row : rows_) {
    const CellState state = states_[row.cell];
    const bool is_away =
        state == CellState::nearer || state == CellState::farther || state == CellState::dark;
    const float change = depth_m_[row.cell] - map_.cells()[row.cell].depth_m - offset;
    const bool is_as_it_was =
        state == CellState::same && std::abs(change) < std::max(kAsItWas_m, kAsItWasSigmas * row.sigma_m);
    if (is_away)
      trust_.add(row.cell, CellTrust::Seen::something_else);
    else if (is_as_it_was)
      trust_.add(row.cell, CellTrust::Seen::as_it_was);
  }
}

BackgroundObservation BackgroundMatcher::match(const DepthImage& depth, std::span<const std::uint8_t> robot,
                                               const Eigen::Matrix3d& R_base_sensor) {
  sample(depth);
  choose(robot);
  const Fit found = fit();
  BackgroundObservation observation;
  classify(robot, found, observation);
  observation.has_evidence = found.used >= kLeastCells && observation.share(CellState::same) >= kLeastShare;
  if (found.used < kLeastCells) return observation;
  const Matrix6d turn = turn_of_axes(R_base_sensor);
  observation.shift = turn * found.solution.head<6>();
  observation.covariance = turn * found.covariance.topLeftCorner<6, 6>() * turn.transpose();
  find_support(found, turn, observation);
  observation.offset_change_m = found.solution[6];
  observation.offset_sigma_m = std::sqrt(found.covariance(6, 6));
  observation.scatter = found.scatter;
  observation.common_share = std::min(1.0, kUnmodelledShare + found.common / static_cast<double>(found.used));
  if (observation.has_evidence && std::abs(observation.known_offset_m()) < kFarKernel_m)
    last_offset_m_ = observation.known_offset_m();
  if (!observation.unsupported) follow_trust(observation);
  return observation;
}

}  // namespace calibrd
