// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>

#include "core/sensing/images.hpp"

namespace calibrd {

/// How much later than its turn a frame came. A sensor delivers at equal intervals; frames are stamped when
/// they arrive, and on a busy machine some arrive late: the interval before is long then. Not thread-safe.
class FrameCadence {
 public:
  void add(std::uint64_t sequence, Clock::time_point stamp);

  /// Of the frame that arrived at `stamp`, or of one of the four before it, s; 0 where too few are known.
  double delay_s(Clock::time_point stamp) const;

 private:
  struct Frame {
    std::uint64_t sequence;
    Clock::time_point stamp;
  };
  std::deque<Frame> frames_;  // oldest first
};

}  // namespace calibrd
