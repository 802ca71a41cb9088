// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>

namespace calibrd::fleet {

/// How long to wait before the next connection. A value: no clock, no I/O.
class BackOff {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// After a connection that lasted so long; 0: it never stood. `share`, 0 to 1, spreads those who lost a
  /// broker together.
  Milliseconds next(Milliseconds lasted, double share) {
    // One that is ended at once, as of two clients of one name, must not be tried ever faster.
    if (lasted >= kSteady) pause_ = kFirst;
    const auto now = pause_;
    pause_ = std::min(2 * pause_, kLast);
    return std::max(
        kFirst, Milliseconds(static_cast<long>(static_cast<double>(now.count()) * (0.75 + 0.25 * share))));
  }

 private:
  static constexpr Milliseconds kFirst{500}, kLast{5000}, kSteady{10'000};
  Milliseconds pause_ = kFirst;
};

}  // namespace calibrd::fleet
