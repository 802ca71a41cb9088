// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "core/drift/background_match.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// A shift that one thing in view alone shows, over frames: either it was pushed, or the sensor has slid; and
/// what the robot says of that. Comparisons of one posture all err alike, so each posture has one voice.
/// Without I/O.
class ShiftDispute {
 public:
  void reset() { *this = ShiftDispute(); }
  /// A frame shows it: in `window`, by `turn_shift` of the middle of the background.
  void add(const CellWindow& window, const Vector6d& turn_shift, double now_s);
  /// A frame does not: it shows `turn_shift` within its noise. A few of these end nothing.
  void add_none(const Vector6d& turn_shift, double now_s);
  /// By how much (−2 log likelihood) a comparison with the robot, which stood as `joints` say, speaks for a
  /// sensor that stands rather than for one that has slid so. What was said counts while the shift stays what
  /// it is; a posture that the robot comes back to has no further voice.
  void hear(double preference, std::span<const double> joints, double now_s);
  /// The robot says that the sensor stands ...
  bool is_denied() const;
  /// ... or, in several postures, that it has slid.
  bool is_affirmed() const;
  /// It is known what it was.
  void settle(double now_s) {
    since_s_ = -1;
    ended_s_ = now_s;
  }

  bool is_open() const { return since_s_ >= 0; }
  double since_s() const { return since_s_; }
  bool is_open_for(double seconds, double now_s) const { return is_open() && now_s - since_s_ > seconds; }
  const CellWindow& window() const { return window_; }
  const Vector6d& turn_shift() const { return turn_shift_; }  ///< mean of the last frames

 private:
  struct Voice {
    std::vector<double> joints;
    double mean = 0;
    int comparisons = 0;
  };
  struct Heard {
    Vector6d of = Vector6d::Zero();  // the shift that it is said of
    std::vector<Voice> voices;
    double since_s = 0, newest_s = 0;
  };
  void follow(const Vector6d& turn_shift);
  double heard() const;

  double share_ = 0;  // of the last frames, that show it
  int frames_ = 0;    // that turn_shift_ is the mean of
  double since_s_ = -1, ended_s_ = -1e9;
  CellWindow window_;
  Vector6d turn_shift_ = Vector6d::Zero();
  Heard heard_;
};

}  // namespace calibrd
