// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "core/sensing/images.hpp"
#include "server/live_cell/freeze_watch.hpp"

namespace calibrd {

/// The joint states of the last seconds, oldest first. Not thread-safe.
class JointHistory {
 public:
  explicit JointHistory(Clock::duration span = std::chrono::seconds(2)) : span_(span), freeze_(span) {}

  /// States not newer than the newest, or with another number of joints, start a new history or are ignored.
  void add(JointState state);
  /// A status of that moment. Unset: the controller does not know whether it moves.
  void note_status(Clock::time_point stamp, std::optional<bool> in_motion) {
    freeze_.on_status(stamp, in_motion);
  }
  const FreezeWatch& freeze() const { return freeze_; }

  const JointState* newest() const { return states_.empty() ? nullptr : &states_.back(); }
  const std::deque<JointState>& states() const { return states_; }

  /// The two neighbouring states with before.stamp <= time <= after.stamp, or nothing.
  struct Bracket {
    const JointState* before;
    const JointState* after;
  };
  std::optional<Bracket> around(Clock::time_point time) const;

  /// Positions at `time`, linear between the states around it (rad or m).
  std::optional<std::vector<double>> positions_at(Clock::time_point time) const;

  /// How far any one joint moved (largest minus smallest position, rad) from `begin` to `end`, both covered
  /// by states; nothing when they are not, or when the states between lie further apart than `max_gap`.
  std::optional<double> motion(Clock::time_point begin, Clock::time_point end, Clock::duration max_gap) const;

 private:
  Clock::duration span_;
  std::deque<JointState> states_;
  FreezeWatch freeze_;
};

}  // namespace calibrd
