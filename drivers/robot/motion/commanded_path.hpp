// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "core/sensing/images.hpp"
#include "drivers/robot/motion/joint_move.hpp"

namespace calibrd {

struct PathTolerance {
  double joint_rad = 0.0175;
  Clock::duration lag = std::chrono::milliseconds(500);   ///< the robot may follow so late …
  Clock::duration lead = std::chrono::milliseconds(100);  ///< … or be so early: the wire's own delay
};

/// A move the robot has been told to make, and since when.
class CommandedPath {
 public:
  explicit CommandedPath(JointMove move) : move_(std::move(move)) {}

  const JointMove& move() const { return move_; }
  void begin(Clock::time_point now) { begun_ = now; }
  bool has_begun() const { return begun_.has_value(); }
  double elapsed_s(Clock::time_point now) const;

  /// The robot is not where the move may have brought it by `stamp`: it has left the straight way, runs
  /// ahead, or does not follow. Error: MotionError::off_path, naming the joint and how far it is off.
  std::optional<Error> deviation(std::span<const double> positions_rad, Clock::time_point stamp,
                                 const PathTolerance& tolerance) const;

 private:
  JointMove move_;
  std::optional<Clock::time_point> begun_;
};

/// The joint that is farthest from where it should be, from 0, and by how much.
struct JointGap {
  std::size_t joint = 0;
  double rad = 0;
};
JointGap widest_gap(std::span<const double> a, std::span<const double> b);

}  // namespace calibrd
