// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/scene_change.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

/// Where the noise of one frame grows as the square of the distance does.
constexpr float kSameDepth_m = 0.02F, kSameDepthUpTo_m = 1.5F;

float same_depth_m(float depth_m) {
  const float far = std::max(1.0F, depth_m / kSameDepthUpTo_m);
  return kSameDepth_m * far * far;
}

}  // namespace

void SceneChange::reset() { *this = SceneChange(settings_, static_cast<int>(width_)); }

void SceneChange::add(std::span<const CellState> states, std::span<const float> depth_m,
                      std::span<const std::uint8_t> ignored, double now_s) {
  cells_.resize(states.size());
  mean_depth_m_.resize(states.size());
  mean_frames_.resize(states.size());
  changed_.assign(states.size(), 0);
  now_s_ = now_s;
  for (std::size_t i = 0; i < states.size(); ++i) {
    Cell& cell = cells_[i];
    const CellState state = states[i];
    const bool hidden = state == CellState::robot || state == CellState::dark;
    const bool same = state == cell.state && std::abs(depth_m[i] - cell.depth_m) < same_depth_m(cell.depth_m);
    if (!same && !hidden) {
      cell = {state, depth_m[i], now_s};
      mean_frames_[i] = 0;
    }
    if (!hidden) {
      mean_frames_[i] = std::min(mean_frames_[i] + 1, BackgroundMap::kMostFrames);
      mean_depth_m_[i] += (depth_m[i] - mean_depth_m_[i]) / mean_frames_[i];
      cell.depth_m = mean_depth_m_[i];
    }
    // The robot hides a cell for a while, or a pixel fails: what had settled there still holds.
    if (hidden && now_s - cell.since_s < settings_.settle_s) continue;
    const bool changed = cell.state == CellState::nearer || cell.state == CellState::farther;
    changed_[i] = changed && (ignored.empty() || ignored[i] == 0) ? 1 : 0;
  }
  count(now_s);
}

bool SceneChange::is_surrounded(std::size_t cell) const {
  if (cell < width_ || cell + width_ >= changed_.size()) return false;
  return (changed_[cell - 1] & changed_[cell + 1] & changed_[cell - width_] & changed_[cell + width_]) != 0;
}

void SceneChange::count(double now_s) {
  std::size_t gone = 0, come = 0, come_long = 0, all = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (changed_[i] == 0 || !is_surrounded(i)) continue;
    ++all;
    const double age = now_s - cells_[i].since_s;
    const bool settled = age >= settings_.settle_s;
    if (cells_[i].state == CellState::farther)
      gone += settled ? 1 : 0;
    else
      come += settled ? 1 : 0;
    come_long += cells_[i].state == CellState::nearer && age >= settings_.stand_s ? 1 : 0;
  }
  // Where something has gone, what has come is it: it need not stand as long as what only came.
  settled_ = gone + (gone >= settings_.least_cells ? come : come_long);
  passing_ = all - settled_;
}

std::vector<std::uint8_t> SceneChange::unchanged_for(double seconds) const {
  std::vector<std::uint8_t> chosen(cells_.size(), 0);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    const bool other = cell.state == CellState::nearer || cell.state == CellState::farther ||
                       cell.state == CellState::unknown;
    chosen[i] = other && cell.depth_m > 0 && now_s_ - cell.since_s >= seconds ? 1 : 0;
  }
  return chosen;
}

}  // namespace calibrd
