// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/drift/background_map.hpp"
#include "core/drift/cell_trust.hpp"
#include "core/drift/stands_within.hpp"
#include "core/drift/window_support.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// What has become of one cell of the background in a frame.
enum class CellState : std::uint8_t {
  unknown,  ///< nothing is remembered here
  robot,    ///< hidden by the robot, or too near its outline
  dark,     ///< no measurement
  same,
  nearer,  ///< something stands in front
  farther  ///< what was here is gone
};

/// A square part of the cells: its first column and row, and its side.
struct CellWindow {
  int x = 0, y = 0, side = 0;
  bool holds(int column, int row) const {
    return column >= x && column < x + side && row >= y && row < y + side;
  }
};

/// One frame against the remembered background.
struct BackgroundObservation {
  bool has_evidence = false;  ///< enough of the background is where a sensor about here would see it
  /// Where the sensor seems to be, as perturbed() takes it, from the pose at which the background was learnt.
  Vector6d shift = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  /// The same without the one part of the image that speaks loudest for a shift: see
  /// least_shift_without_a_window().
  Vector6d supported_shift = Vector6d::Zero();
  Matrix6d supported_covariance = Matrix6d::Zero();
  /// The part that is left out: where the frame, taken whole, shows a shift beyond the tolerance.
  std::optional<CellWindow> unsupported;
  double offset_change_m = 0;  ///< of the range, since then
  double offset_sigma_m = 0;
  /// Of that what can be relied on: before a single wall an offset looks like a shift.
  double known_offset_m() const { return offset_sigma_m < kKnownOffset_m ? offset_change_m : 0; }
  static constexpr double kKnownOffset_m = 0.003;
  double scatter = 1;  ///< residuals against what noise explains
  /// Of the covariance: what all frames have in common, the noise of the map and what no model of it has.
  double common_share = 0;
  bool realigned = false;  ///< the background had to be searched: it lies far from where it should
  std::array<std::size_t, 6> counts{};  ///< cells of each CellState
  std::size_t count(CellState state) const { return counts[static_cast<std::size_t>(state)]; }
  /// Cells that could tell: remembered, not hidden by the robot.
  std::size_t visible() const {
    return count(CellState::dark) + count(CellState::same) + count(CellState::nearer) +
           count(CellState::farther);
  }
  double share(CellState state) const {
    return visible() > 0 ? static_cast<double>(count(state)) / static_cast<double>(visible()) : 0;
  }
};

/// Follows the sensor by what it sees of the background: point-to-plane on the remembered planes, pose and
/// range offset free, robustly (Tukey), because people, boxes and what the robot carries are in front of it.
/// The covariance holds the correlation between neighbouring pixels and the scatter that was found; a
/// direction that the background does not show has a large one. One thread at a time.
class BackgroundMatcher {
 public:
  /// `map` must outlive it. `tolerance`: of turn (rad) and shift (m) of the middle of the background; a shift
  /// within it needs no support.
  explicit BackgroundMatcher(const BackgroundMap& map,
                             const Vector6d& tolerance = Vector6d::Constant(kStandsWithin))
      : map_(map), tolerance_(tolerance) {
    start_over();
  }
  /// To be called when parts of the map have changed ...
  void refresh();
  /// ... and when it is another one.
  void start_over() {
    last_offset_m_ = 0;
    trust_.reset(map_.cells().size());
    refresh();
  }

  /// `robot`: one value per cell, 1 = hidden by the robot. `R_base_sensor`: of the pose the map was learnt
  /// at.
  BackgroundObservation match(const DepthImage& depth, std::span<const std::uint8_t> robot,
                              const Eigen::Matrix3d& R_base_sensor);

  /// Of the last frame, row-major cells.
  const std::vector<CellState>& states() const { return states_; }
  /// Depth of the last frame on the cells, m; 0 = no measurement.
  const std::vector<float>& depth_m() const { return depth_m_; }

 private:
  static constexpr int kParameters = kBackgroundParameters;
  struct Row {
    std::uint32_t cell = 0, cluster = 0, tile = 0;
    float sigma_m = 0;
    /// Of the depth by the parameters; an eighth, 0, makes two whole vectors of it.
    Eigen::Matrix<float, kParameters + 1, 1> slope = Eigen::Matrix<float, kParameters + 1, 1>::Zero();
  };
  struct Fit;
  int tile_side() const;  // cells
  void sample(const DepthImage& depth);
  void choose(std::span<const std::uint8_t> robot);
  void follow_trust(const BackgroundObservation& observation);
  void add_spurious(const BackgroundCell& known, const Eigen::Vector3f& ray);
  Fit fit();
  Fit descend(double first_kernel_m);
  void collect(const BackgroundVector& at, double kernel_m, Fit& fit);
  void classify(std::span<const std::uint8_t> robot, const Fit& fit, BackgroundObservation& observation);

  void find_support(const Fit& fit, const Matrix6d& turn, BackgroundObservation& observation) const;

  const BackgroundMap& map_;
  const Vector6d tolerance_;
  std::vector<Row> rows_;
  BackgroundMatrix spurious_ =
      BackgroundMatrix::Zero();  // information that is but noise of the planes' normals
  std::size_t clusters_ = 0, tiles_ = 0;
  std::vector<float> depth_m_;
  CellTrust trust_;
  std::vector<std::uint8_t> speaks_;  // of the cells: measured in this frame, not the robot, trusted
  std::vector<CellState> states_;
  std::vector<float> whitened_;
  std::vector<double> pulls_;
  double last_offset_m_ = 0;  // where the next frame starts
};

}  // namespace calibrd
