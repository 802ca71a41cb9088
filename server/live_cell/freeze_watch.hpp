// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "core/sensing/images.hpp"

namespace calibrd {

/// What the controller's status says about its joints: that the robot moves, and so that joints which repeat
/// to the last bit are not read any more. Without I/O; not thread-safe.
class FreezeWatch {
 public:
  explicit FreezeWatch(Clock::duration span) : span_(span) {}

  /// `changed`: the positions differ from those before them, in whatever bit.
  void on_joints(Clock::time_point stamp, bool changed);
  void on_status(Clock::time_point stamp, std::optional<bool> in_motion);

  /// Joints have repeated while the status said for kPatience, in one go or in several, that the robot moves.
  /// It holds until they change: when such a robot stops, it stands elsewhere.
  bool is_frozen() const { return is_frozen_; }
  /// A status from between the two said that the robot moves.
  bool said_in_motion(Clock::time_point begin, Clock::time_point end) const;
  std::optional<Clock::time_point> newest_status() const { return newest_status_; }

 private:
  Clock::duration span_;
  std::deque<Clock::time_point> in_motion_;        // stamps of the statuses that said so
  Clock::duration unchanged_{0};                   // of motion, since the joints changed last
  std::optional<Clock::time_point> in_motion_at_;  // when that was last said; nothing: it stands
  std::optional<Clock::time_point> newest_status_;
  bool is_frozen_ = false;
};

}  // namespace calibrd
