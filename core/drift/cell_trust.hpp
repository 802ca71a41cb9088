// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace calibrd {

/// Which cells of the background may speak of a move of the sensor: those that have not shown something else
/// lately. Where a box was taken away, whatever comes next and lies about there would else look like the box,
/// seen by a sensor that has slid. A cell that has shown something else for half a second is trusted again
/// once it shows what it did. Without I/O.
class CellTrust {
 public:
  enum class Seen : std::uint8_t { nothing, as_it_was, something_else };

  void reset(std::size_t cells) { away_.assign(cells, 0); }
  /// One frame of one cell, of a sensor that shows no sign of having moved.
  void add(std::size_t cell, Seen seen) {
    std::uint8_t& away = away_[cell];
    if (seen == Seen::something_else && away < kMost) ++away;
    if (seen == Seen::as_it_was)
      away = away > kBack ? static_cast<std::uint8_t>(away - kBack) : std::uint8_t{0};
  }
  bool is_trusted(std::size_t cell) const { return away_[cell] < kAway; }

 private:
  static constexpr std::uint8_t kAway = 15, kMost = 45, kBack = 3;  // frames
  std::vector<std::uint8_t> away_;
};

}  // namespace calibrd
