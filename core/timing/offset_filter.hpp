// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

namespace calibrd {

/// The time offset (s), and what could be mistaken for it: the pose being off (rad, m; about the base's
/// origin, base axes) and the range being off (m).
constexpr int kOffsetParameters = 8;
using OffsetVector = Eigen::Matrix<double, kOffsetParameters, 1>;
using OffsetMatrix = Eigen::Matrix<double, kOffsetParameters, kOffsetParameters>;

/// What one frame says: a normal distribution as information · x = gradient.
struct OffsetEquations {
  OffsetMatrix information = OffsetMatrix::Zero();
  OffsetVector gradient = OffsetVector::Zero();
};

/// Sums the pixels of one frame. Weights are brought down to what residuals that correlate within clusters
/// are worth.
class OffsetSums {
 public:
  explicit OffsetSums(std::size_t clusters) : clusters_(clusters, 0.0) {}

  /// `value` = jacobian · x + noise. `residual`: as it stands now, for judging the noise.
  void add(const OffsetVector& jacobian, double value, double residual, double sigma, double robust_weight,
           std::size_t cluster);
  std::size_t count() const { return count_; }
  OffsetEquations equations() const;

 private:
  OffsetEquations sums_;
  std::vector<double> clusters_;
  std::vector<float> whitened_;
  double squares_ = 0;
  std::size_t count_ = 0;
};

struct OffsetFilterSettings {
  double block_s = 0.4;  ///< frames so close together share what is wrong with the model at their posture
  /// How far pose and range may be off for good, and how far beside that in one posture: joint zeros, meshes,
  /// what the range error's formula leaves. Rad, m.
  double pose_rad = 2e-3, pose_m = 2e-3, range_m = 2e-3;
  double posture_rad = 0.7e-3, posture_m = 0.7e-3, posture_range_m = 0.7e-3;
  double offset_prior_s = 0.3;
  std::size_t memory_blocks = 300;  ///< older ones are forgotten slowly
  std::size_t least_blocks = 6;     ///< before anything is said
  double gate_sigmas = 5;           ///< a block farther off than this, and than gate_s, is left out
  double gate_s = 0.010;
  double lost_sigmas = 2;  ///< farther off than this, and than gate_s, to one side, ...
  int blocks_to_lost = 7;  ///< ... and so many in a row: the offset is another one now
};

/// Fuses frames of a moving robot into one time offset. What to-and-fro tells apart is told apart: the pose's
/// error is one unknown for all frames, the offset's effect turns with the motion. Its sigma is honest in
/// that it follows how far blocks of frames scatter about the result, not how many pixels there were. Not
/// thread-safe.
class OffsetFilter {
 public:
  explicit OffsetFilter(const OffsetFilterSettings& settings = {}) : settings_(settings) { reset(); }
  void reset();
  /// Keeps the offset, half as certain as it was, and begins anew with all else.
  void forget_pose();

  /// `time_s` on any clock, going forward.
  void add(const OffsetEquations& frame, double time_s);

  struct Estimate {
    double offset_s;
    double sigma_s;
    double jitter_s;  ///< of single frames about it, beyond what their noise explains
    std::size_t blocks;
  };
  /// Nothing before least_blocks.
  std::optional<Estimate> estimate() const;
  /// What counts while too few blocks are in: nothing before the first.
  std::optional<double> working_value() const;
  /// So many blocks in a row have disagreed that all before them no longer holds.
  bool is_lost() const { return std::abs(far_in_row_) >= settings_.blocks_to_lost; }

 private:
  void begin(double offset_s, double sigma_s);
  void close_block();
  void count_far(double off_s);
  void judge_frames(const OffsetVector& state);
  double scatter() const;

  OffsetFilterSettings settings_;
  OffsetEquations total_;
  std::vector<OffsetEquations> block_;
  double block_begin_s_ = 0;
  std::size_t blocks_ = 0;
  int far_in_row_ = 0;                               // signed
  double scatter_weight_ = 0, scatter_squares_ = 0;  // of whitened block innovations
  double frame_excess_ = 0, frame_weight_ = 0;       // of single frames about their block
};

}  // namespace calibrd
