// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>

namespace calibrd {

/// Notices that this process did not run for a while (stopped, frozen, starved). Frames are stamped when they
/// are read, for drivers' own times are of no known clock: what they held back meanwhile would get the stamp
/// of a moment long after its exposure. So for a while nothing that comes is used. Without I/O.
class HoldUp {
 public:
  using Clock = std::chrono::steady_clock;

  /// Says that the process runs. More often than every `longest` while all is well.
  void look(Clock::time_point now) {
    if (last_ && now - *last_ > kLongest) distrusted_until_ = now + kFlush;
    last_ = now;
  }
  /// A frame read now may be stamped with this moment.
  bool is_over(Clock::time_point now) const { return !distrusted_until_ || now >= *distrusted_until_; }

 private:
  /// The loop waits 100 ms at most. A frame this late still lies within what calibration.settle_time demands
  /// of the robot before it.
  static constexpr std::chrono::milliseconds kLongest{300};
  /// In which buffered frames, and the one being made, have come through: several periods of a slow device.
  static constexpr std::chrono::milliseconds kFlush{500};
  std::optional<Clock::time_point> last_, distrusted_until_;
};

}  // namespace calibrd
