// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/offset_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/registration/linearization.hpp"

namespace calibrd {
namespace {

constexpr int kNuisances = kOffsetParameters - 1;
using NuisanceVector = Eigen::Matrix<double, kNuisances, 1>;
using NuisanceMatrix = Eigen::Matrix<double, kNuisances, kNuisances>;

NuisanceVector information_of(double rotation_rad, double position_m, double range_m) {
  NuisanceVector sigma;
  sigma << Eigen::Vector3d::Constant(rotation_rad), Eigen::Vector3d::Constant(position_m), range_m;
  return sigma.array().square().inverse();
}

/// Leaves out what a nuisance of this prior information of its own may explain (Schur complement).
OffsetEquations with_own_nuisance(const OffsetEquations& equations, const NuisanceVector& prior) {
  const Eigen::Matrix<double, kOffsetParameters, kNuisances> columns =
      equations.information.rightCols<kNuisances>();
  NuisanceMatrix inner = equations.information.bottomRightCorner<kNuisances, kNuisances>();
  inner.diagonal() += prior;
  const Eigen::LDLT<NuisanceMatrix> solver(inner);
  OffsetEquations reduced;
  reduced.information = equations.information - columns * solver.solve(columns.transpose());
  reduced.gradient = equations.gradient - columns * solver.solve(equations.gradient.tail<kNuisances>());
  return reduced;
}

}  // namespace

void OffsetSums::add(const OffsetVector& jacobian, double value, double residual, double sigma,
                     double robust_weight, std::size_t cluster) {
  const double weight = robust_weight / (sigma * sigma), pull = robust_weight * residual / sigma;
  sums_.information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
  sums_.gradient += weight * value * jacobian;
  clusters_[cluster] += pull;
  squares_ += pull * pull;
  whitened_.push_back(static_cast<float>(residual / sigma));
  ++count_;
}

OffsetEquations OffsetSums::equations() const {
  double cluster_squares = 0;
  for (const double pull : clusters_) cluster_squares += pull * pull;
  const double scatter = robust_sigma(whitened_);
  const double correlation = squares_ > 0 ? std::max(1.0, cluster_squares / squares_) : 1;
  const double worth = 1 / (scatter * scatter * correlation);
  OffsetEquations equations;
  equations.information = worth * OffsetMatrix(sums_.information.selfadjointView<Eigen::Lower>());
  equations.gradient = worth * sums_.gradient;
  return equations;
}

void OffsetFilter::begin(double offset_s, double sigma_s) {
  total_ = {};
  total_.information(0, 0) = 1 / (sigma_s * sigma_s);
  total_.gradient[0] = offset_s / (sigma_s * sigma_s);
  total_.information.diagonal().tail<kNuisances>() =
      information_of(settings_.pose_rad, settings_.pose_m, settings_.range_m);
  block_.clear();
}

void OffsetFilter::forget_pose() {
  if (blocks_ == 0) return;
  constexpr double kDoubt = 2;
  const Eigen::LDLT<OffsetMatrix> solver(total_.information);
  begin(solver.solve(total_.gradient)[0], kDoubt * std::sqrt(solver.solve(OffsetVector::Unit(0))[0]));
}

void OffsetFilter::reset() {
  begin(0, settings_.offset_prior_s);
  blocks_ = 0;
  far_in_row_ = 0;
  scatter_weight_ = scatter_squares_ = 0;
  frame_excess_ = frame_weight_ = 0;
}

void OffsetFilter::add(const OffsetEquations& frame, double time_s) {
  if (!block_.empty() && std::abs(time_s - block_begin_s_) > settings_.block_s) close_block();
  if (block_.empty()) block_begin_s_ = time_s;
  block_.push_back(frame);
}

void OffsetFilter::close_block() {
  OffsetEquations sum;
  for (const auto& frame : block_) {
    sum.information += frame.information;
    sum.gradient += frame.gradient;
  }
  const auto block = with_own_nuisance(
      sum, information_of(settings_.posture_rad, settings_.posture_m, settings_.posture_range_m));
  const OffsetVector state = total_.information.ldlt().solve(total_.gradient);
  const double worth = block.information(0, 0);
  if (blocks_ >= 2 && worth > 0) {
    // This block alone, the pose's error being what all others say.
    const double alone_s =
        (block.gradient[0] - block.information.row(0).tail<kNuisances>().dot(state.tail<kNuisances>())) /
        worth;
    const double off_s = alone_s - state[0], sigmas = std::abs(off_s) * std::sqrt(worth);
    const bool far = blocks_ >= settings_.least_blocks && std::abs(off_s) > settings_.gate_s;
    count_far(far && sigmas > settings_.lost_sigmas ? off_s : 0);
    if (far && sigmas > settings_.gate_sigmas * std::max(1.0, scatter())) return block_.clear();
    const double keep = 1 - 1 / static_cast<double>(settings_.memory_blocks);
    scatter_weight_ = keep * scatter_weight_ + 1;
    scatter_squares_ = keep * scatter_squares_ + sigmas * sigmas;
  }
  const double keep = 1 - 1 / static_cast<double>(settings_.memory_blocks);
  total_.information = keep * total_.information + block.information;
  total_.gradient = keep * total_.gradient + block.gradient;
  ++blocks_;
  judge_frames(total_.information.ldlt().solve(total_.gradient));
  block_.clear();
}

/// Blocks that scatter lie off to either side; blocks of another offset all to one.
void OffsetFilter::count_far(double off_s) {
  if (off_s * far_in_row_ <= 0) far_in_row_ = 0;
  if (off_s != 0) far_in_row_ += off_s > 0 ? 1 : -1;
}

/// How far single frames of the block lie about each other, beyond what their pixels explain: the stamps'
/// jitter, as DerSimonian and Laird (1986) tell the variance between studies.
void OffsetFilter::judge_frames(const OffsetVector& state) {
  double sum = 0, weights = 0, squared_weights = 0, count = 0;
  std::vector<std::pair<double, double>> alone;  // offset, its weight
  for (const auto& frame : block_) {
    const double weight = frame.information(0, 0);
    if (weight <= 0) continue;
    const double explained = frame.information.row(0).tail<kNuisances>().dot(state.tail<kNuisances>());
    alone.emplace_back((frame.gradient[0] - explained) / weight, weight);
    sum += weight * alone.back().first;
    weights += weight;
    squared_weights += weight * weight;
    ++count;
  }
  if (alone.size() < 2) return;
  const double mean = sum / weights, keep = 1 - 1 / static_cast<double>(settings_.memory_blocks);
  double excess = 1 - count;
  for (const auto& [offset_s, weight] : alone) excess += weight * (offset_s - mean) * (offset_s - mean);
  frame_excess_ = keep * frame_excess_ + excess;
  frame_weight_ = keep * frame_weight_ + weights - squared_weights / weights;
}

/// Of blocks about the result, over what their equations and the allowance for postures explain.
double OffsetFilter::scatter() const {
  constexpr double kLeast = 0.5, kDoubt = 4;  // that they scatter less is not believed at once
  return std::max(kLeast, std::sqrt((scatter_squares_ + kDoubt) / (scatter_weight_ + kDoubt)));
}

std::optional<double> OffsetFilter::working_value() const {
  if (blocks_ == 0) return std::nullopt;
  return total_.information.ldlt().solve(total_.gradient)[0];
}

std::optional<OffsetFilter::Estimate> OffsetFilter::estimate() const {
  if (blocks_ < settings_.least_blocks || scatter_weight_ <= 0) return std::nullopt;
  const Eigen::LDLT<OffsetMatrix> solver(total_.information);
  const double variance = solver.solve(OffsetVector::Unit(0))[0];
  const double jitter = frame_weight_ > 0 ? std::max(0.0, frame_excess_ / frame_weight_) : 0;
  return Estimate{solver.solve(total_.gradient)[0], std::sqrt(variance) * scatter(), std::sqrt(jitter),
                  blocks_};
}

}  // namespace calibrd
