// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "core/drift/background_match.hpp"

namespace calibrd {

struct SceneChangeSettings {
  double settle_s = 1;           ///< what has gone, and stays so for this long, is a change of the scene
  double stand_s = 4;            ///< ... what has come
  std::size_t least_cells = 12;  ///< with three neighbours of four changed, too: edges flicker
  /// What was measured and is dark is a change for so long: something black has come, or nothing is in reach
  /// where something was.
  double dark_s = 60;
};

/// Tells what passes in front of the background from what has changed for good: the former moves. Follows
/// each cell's depth from frame to frame. Not thread-safe.
class SceneChange {
 public:
  /// `width`: cells per row.
  SceneChange(const SceneChangeSettings& settings, int width)
      : settings_(settings), width_(static_cast<std::size_t>(width)) {}

  /// `ignored`: one value per cell, 1 = of no interest (what the robot carries); may be empty.
  void add(std::span<const CellState> states, std::span<const float> depth_m,
           std::span<const std::uint8_t> ignored, double now_s);
  void reset();

  bool has_changed() const { return settled_ >= settings_.least_cells; }
  bool is_something_in_front() const { return passing_ >= settings_.least_cells; }

  /// Cells that have shown one and the same other depth for `seconds`, or that nothing was known of:
  /// row-major, 1 = so.
  std::vector<std::uint8_t> unchanged_for(double seconds) const;
  /// What a cell has shown since it came to show it: mean depth, and of how many frames (at most the last
  /// BackgroundMap::kMostFrames or so).
  const std::vector<float>& mean_depth_m() const { return mean_depth_m_; }
  const std::vector<float>& mean_frames() const { return mean_frames_; }
  /// Begins the means anew.
  void forget_means() { mean_frames_.assign(mean_frames_.size(), 0); }

 private:
  struct Cell {
    CellState state = CellState::same;
    float depth_m = 0;
    double since_s = 0;  // when it came to show this
    double dark_since_s = -1;
  };
  void count(double now_s);
  bool is_dark_change(const Cell& cell) const;
  int changed_neighbours(std::size_t cell) const;

  SceneChangeSettings settings_;
  std::size_t width_;
  std::vector<Cell> cells_;
  std::vector<float> mean_depth_m_, mean_frames_;
  std::vector<std::uint8_t> changed_;  // 1: shows something else, and counts
  double now_s_ = 0;
  std::size_t settled_ = 0, passing_ = 0;
};

}  // namespace calibrd
