// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/joint_history.hpp"

#include <algorithm>

namespace calibrd {

void JointHistory::add(JointState state) {
  if (!states_.empty()) {
    if (state.stamp <= states_.back().stamp) return;
    freeze_.on_joints(state.stamp, state.positions_rad != states_.back().positions_rad);
    if (state.positions_rad.size() != states_.back().positions_rad.size()) states_.clear();
  }
  states_.push_back(std::move(state));
  while (states_.back().stamp - states_.front().stamp > span_) states_.pop_front();
}

std::optional<JointHistory::Bracket> JointHistory::around(Clock::time_point time) const {
  const auto after =
      std::lower_bound(states_.begin(), states_.end(), time,
                       [](const JointState& state, Clock::time_point t) { return state.stamp < t; });
  if (after == states_.end()) return std::nullopt;
  if (after->stamp == time) return Bracket{&*after, &*after};
  if (after == states_.begin()) return std::nullopt;
  return Bracket{&*std::prev(after), &*after};
}

std::optional<std::vector<double>> JointHistory::positions_at(Clock::time_point time) const {
  const auto bracket = around(time);
  if (!bracket) return std::nullopt;
  const auto& [before, after] = *bracket;
  const std::chrono::duration<double> whole = after->stamp - before->stamp, part = time - before->stamp;
  const double share = whole.count() > 0 ? part / whole : 0;
  auto positions = before->positions_rad;
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] += share * (after->positions_rad[i] - positions[i]);
  return positions;
}

std::optional<double> JointHistory::motion(Clock::time_point begin, Clock::time_point end,
                                           Clock::duration max_gap) const {
  const auto first = around(begin), last = around(end);
  if (!first || !last) return std::nullopt;
  auto low = first->before->positions_rad, high = low;
  const auto* previous = first->before;
  for (const auto& state : states_) {
    if (state.stamp < first->before->stamp || state.stamp > last->after->stamp) continue;
    if (state.stamp - previous->stamp > max_gap) return std::nullopt;
    previous = &state;
    for (std::size_t i = 0; i < low.size(); ++i) {
      low[i] = std::min(low[i], state.positions_rad[i]);
      high[i] = std::max(high[i], state.positions_rad[i]);
    }
  }
  double most = 0;
  for (std::size_t i = 0; i < low.size(); ++i) most = std::max(most, high[i] - low[i]);
  return most;
}

}  // namespace calibrd
