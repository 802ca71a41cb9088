// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/view_timing.hpp"

#include <algorithm>
#include <vector>

namespace calibrd {
namespace {

double seconds_between(const JointState& a, const JointState& b) {
  return std::chrono::duration<double>(b.stamp - a.stamp).count();
}

/// Of the fastest point, m/s².
double acceleration(const LinkReach& reach, const JointState& a, const JointState& b, const JointState& c) {
  const double ab = seconds_between(a, b), bc = seconds_between(b, c);
  return reach.velocity_change_m_s(a.positions_rad, b.positions_rad, c.positions_rad, ab, bc) /
         (0.5 * (ab + bc));
}

/// Of the fastest point, m/s.
double speed_between(const LinkReach& reach, const JointState& a, const JointState& b) {
  return reach.farthest_m(a.positions_rad, b.positions_rad) / seconds_between(a, b);
}

/// How late messages around `after` came, at most: a controller sends them at equal intervals, and stamps are
/// of their arrival. A late one makes the interval before it long.
double delay_around_s(const std::deque<JointState>& states, std::deque<JointState>::const_iterator after) {
  constexpr std::ptrdiff_t kReach = 4;  // messages to each side
  const auto first = after - std::min(kReach, after - states.begin());
  const auto last = after + std::min(kReach, states.end() - 1 - after);
  std::vector<double> intervals_s;
  for (auto state = first; state != last; ++state)
    intervals_s.push_back(seconds_between(*state, *std::next(state)));
  std::ranges::sort(intervals_s);
  const double usual = intervals_s[intervals_s.size() / 2];
  return std::max(intervals_s.back() - usual, usual - intervals_s.front());
}

}  // namespace

std::optional<double> timing_error_m(const JointHistory& joints, const LinkReach& reach,
                                     Clock::time_point exposed, double sigma_s, double frame_delay_s) {
  const auto& states = joints.states();
  const auto after = std::ranges::lower_bound(states, exposed, {}, &JointState::stamp);
  if (after == states.begin() || after == states.end()) return std::nullopt;
  const auto before = std::prev(after);
  const bool has_earlier = before != states.begin(), has_later = std::next(after) != states.end();
  if (!has_earlier && !has_later) return std::nullopt;
  double bend = 0;
  if (has_earlier) bend = acceleration(reach, *std::prev(before), *before, *after);
  if (has_later) bend = std::max(bend, acceleration(reach, *before, *after, *std::next(after)));
  const double cycle_s = seconds_between(*before, *after);
  return speed_between(reach, *before, *after) * (sigma_s + delay_around_s(states, after) + frame_delay_s) +
         bend * cycle_s * cycle_s / 8;
}

double late_error_m(const JointHistory& joints, const LinkReach& reach, Clock::time_point exposed,
                    double frame_delay_s) {
  const auto& states = joints.states();
  const auto after = std::ranges::lower_bound(states, exposed, {}, &JointState::stamp);
  if (after == states.begin() || after == states.end()) return 0;
  return speed_between(reach, *std::prev(after), *after) * (delay_around_s(states, after) + frame_delay_s);
}

}  // namespace calibrd
