// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/drift/background_match.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// A shift that one thing in view alone shows, over frames: either it was pushed, or the sensor has slid.
/// Without I/O.
class ShiftDispute {
 public:
  void reset() { *this = ShiftDispute(); }
  /// A frame shows it: in `window`, by `turn_shift` of the middle of the background.
  void add(const CellWindow& window, const Vector6d& turn_shift, double now_s);
  /// A frame does not. A few of these end nothing.
  void add_none(double now_s);
  /// The robot says that it is not the sensor's: holds while it stays what it is.
  void deny() { denied_ = turn_shift_; }
  bool is_denied() const;
  /// It is known what it was.
  void settle() { since_s_ = -1; }

  bool is_open() const { return since_s_ >= 0; }
  double since_s() const { return since_s_; }
  bool is_open_for(double seconds, double now_s) const { return is_open() && now_s - since_s_ > seconds; }
  const CellWindow& window() const { return window_; }
  const Vector6d& turn_shift() const { return turn_shift_; }  ///< mean of the last frames

 private:
  double since_s_ = -1, seen_s_ = -1e9;
  CellWindow window_;
  Vector6d turn_shift_ = Vector6d::Zero();
  std::optional<Vector6d> denied_;
};

}  // namespace calibrd
