// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "drivers/sim/world/commanded_motion.hpp"
#include "drivers/sim/world/joints.hpp"

namespace calibrd::sim {

inline constexpr int kMaxPostures = 64;

enum class Profile : std::int32_t {
  minimum_jerk,    ///< quintic: velocity and acceleration vanish at both ends
  constant_speed,  ///< short ramps, between them the stated speed
};

/// Postures visited one after the other, with a hold at each; after the last it goes on at `loop_from`.
struct MotionProgram {
  std::int32_t posture_count = 0;
  std::int32_t loop_from = 0;
  Profile profile = Profile::minimum_jerk;
  double speed_rad_s = 0.3;  ///< highest speed of the fastest joint
  double hold_s = 1.0;
  std::array<Joints, kMaxPostures> postures{};

  /// Where the robot is, `program_s` seconds after the start (>= 0).
  Joints at(double program_s) const;

  /// It is where it stays: one posture in the end, and that is reached.
  bool is_over(double program_s) const;

 private:
  double duration_s(int from, int to) const;
  int after(int posture) const { return posture + 1 < posture_count ? posture + 1 : loop_from; }
  double cycle_s() const;
};

/// Maps the monotonic clock to a program's own time, so that a running robot can be brought to a smooth stop
/// anywhere: its rate goes linearly from `rate_from` to `rate_to` within `ramp_s`.
struct MotionClock {
  std::int64_t start_ns = 0;
  double program_s = 0;
  double rate_from = 1, rate_to = 1;
  double ramp_s = 0;

  double time_at(std::int64_t now_ns) const;
  double rate_at(std::int64_t now_ns) const;
};

struct Motion {
  MotionClock clock;
  MotionProgram program;

  Joints at(std::int64_t now_ns) const { return program.at(clock.time_at(now_ns)); }
};

/// What the robot does now and, after a commanded change, what it does next: until `switch_ns` it comes to
/// rest in `current`. Plain data: it travels through shared memory, and both sides evaluate it at any time.
struct MotionPlan {
  Motion current;
  Motion next;
  std::int64_t switch_ns = 0;
  CommandedMotion commanded;  ///< goes before the others while it has points

  /// True joint positions at a time of CLOCK_MONOTONIC.
  Joints positions_at(std::int64_t now_ns) const;
  /// Per second, by central difference over 1 ms.
  Joints velocities_at(std::int64_t now_ns) const;

  /// Stops smoothly, then visits `postures` for ever (a single one is where it stays). At most kMaxPostures
  /// - 1.
  void visit(std::span<const Joints> postures, Profile profile, double speed_rad_s, double hold_s,
             std::int64_t now_ns);
  /// Brings the robot to rest where it is (0) or lets it go on (1), smoothly.
  void set_rate(double rate, std::int64_t now_ns);
  /// Puts the robot at rest at `posture`, at once: for the start of the world.
  void place(const Joints& posture, std::int64_t now_ns);

  /// A program of its own moves the robot, or will: the motion port has no say then.
  bool is_running(std::int64_t now_ns) const;
  /// Hands the robot, which must not be running, to the motion port.
  void take_commands(std::int64_t now_ns) { commanded.begin(positions_at(now_ns), now_ns); }

 private:
  void end_commands(std::int64_t now_ns);
};

}  // namespace calibrd::sim
