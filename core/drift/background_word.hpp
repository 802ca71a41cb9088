// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// How much of its place the background has shown lately, frame by frame. A frame that shows every direction
/// pins the sensor; where noise alone decides whether one does, a lucky frame proves nothing: most of the
/// last ones must. Without I/O.
class BackgroundWord {
 public:
  void reset() { *this = BackgroundWord(); }
  /// The frames before say nothing of those to come.
  void on_gap() { pinned_share_ = 0; }
  /// A frame with evidence. `is_finely_pinned`: so well that a creep would show before it is worth a word.
  void add(bool is_pinned, bool is_finely_pinned, double now_s);

  /// It has shown every direction within the last `seconds`.
  bool pins_within(double seconds, double now_s) const { return now_s - pinned_s_ < seconds; }
  bool pins_finely_within(double seconds, double now_s) const { return now_s - finely_pinned_s_ < seconds; }

 private:
  double pinned_share_ = 0;  // of the last frames
  double pinned_s_ = -1e9, finely_pinned_s_ = -1e9;
};

}  // namespace calibrd
