// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "drivers/sim/world/joints.hpp"

namespace calibrd::sim {

/// What a client of the motion port makes the robot do: points in time, between them a cubic from the
/// positions and speeds of both ends, as MotoROS interpolates. The last points are kept. Plain data.
struct CommandedMotion {
  static constexpr std::int32_t kMaxPoints = 32;
  struct Point {
    std::int64_t at_ns = 0;
    Joints positions{}, velocities{};
  };
  std::int32_t count = 0;                                           ///< 0: the motion port has no say
  std::int64_t stop_ns = std::numeric_limits<std::int64_t>::max();  ///< from here on the robot stands
  std::array<Point, kMaxPoints> points{};

  Joints at(std::int64_t now_ns) const;
  /// Until when points are there; nothing of them is left afterwards.
  std::int64_t end_ns() const;

  /// Stands at `here`, ready for add().
  void begin(const Joints& here, std::int64_t now_ns);
  /// To be reached `after_s` seconds after the point before, or after now where the robot has run out of
  /// points.
  void add(double after_s, const Joints& positions, const Joints& velocities, std::int64_t now_ns);
  void stop(std::int64_t now_ns);

 private:
  void push(const Point& point);
};

}  // namespace calibrd::sim
