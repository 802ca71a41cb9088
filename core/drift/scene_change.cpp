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
    if (state != CellState::dark)
      cell.dark_since_s = -1;
    else if (cell.dark_since_s < 0)
      cell.dark_since_s = now_s;
    if (!same && !hidden) {
      cell = {state, depth_m[i], now_s, -1};
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
    changed_[i] = (changed || is_dark_change(cell)) && (ignored.empty() || ignored[i] == 0) ? 1 : 0;
  }
  count(now_s);
}

bool SceneChange::is_dark_change(const Cell& cell) const {
  if (cell.dark_since_s < 0 || cell.state == CellState::unknown) return false;
  const double dark_s = now_s_ - cell.dark_since_s;
  return dark_s >= settings_.stand_s && dark_s < settings_.dark_s;
}

int SceneChange::changed_neighbours(std::size_t cell) const {
  if (cell < width_ || cell + width_ >= changed_.size()) return 0;
  return changed_[cell - 1] + changed_[cell + 1] + changed_[cell - width_] + changed_[cell + width_];
}

void SceneChange::count(double now_s) {
  std::size_t gone = 0, come = 0, come_long = 0, all = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const int neighbours = changed_[i] == 0 ? 0 : changed_neighbours(i);
    if (neighbours < 3) continue;
    const Cell& cell = cells_[i];
    const double age = now_s - cell.since_s;
    const bool settled = age >= settings_.settle_s, is_dark = is_dark_change(cell);
    gone += cell.state == CellState::farther && settled ? 1 : 0;
    come += cell.state == CellState::nearer && settled ? 1 : 0;
    come_long += is_dark || (cell.state == CellState::nearer && age >= settings_.stand_s) ? 1 : 0;
    all += neighbours == 4 && !is_dark ? 1 : 0;
  }
  // Where something has gone, what has come is it: it need not stand as long as what only came.
  settled_ = gone + (gone >= settings_.least_cells ? come : come_long);
  passing_ = all > settled_ ? all - settled_ : 0;
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
