// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/motion.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::sim {
namespace {

constexpr double kStopRamp_s = 0.3;
constexpr double kSpeedRamp_s = 0.2;
constexpr double kMinimumJerkPeak = 1.875;  // peak over mean speed of the quintic
constexpr double kSecondsPerNs = 1e-9;

std::int64_t to_ns(double seconds) { return std::llround(seconds * 1e9); }

double minimum_jerk(double s) { return s * s * s * (10 + s * (-15 + 6 * s)); }

/// Fraction of the way after `t` of `duration`, with parabolic ends of `ramp`.
double trapezoid(double t, double duration, double ramp) {
  const double speed = 1.0 / (duration - ramp);
  if (t < ramp) return 0.5 * speed * t * t / ramp;
  if (t > duration - ramp) return 1.0 - 0.5 * speed * (duration - t) * (duration - t) / ramp;
  return speed * (t - 0.5 * ramp);
}

double ramp_of(double duration) { return std::min(kSpeedRamp_s, 0.5 * duration); }

}  // namespace

double MotionProgram::duration_s(int from, int to) const {
  double farthest = 0;
  for (std::size_t j = 0; j < kMaxJoints; ++j)
    farthest = std::max(farthest, std::abs(postures[static_cast<std::size_t>(to)][j] -
                                           postures[static_cast<std::size_t>(from)][j]));
  const double at_speed_s = farthest / speed_rad_s;
  if (profile == Profile::minimum_jerk) return kMinimumJerkPeak * at_speed_s;
  // Below the ramp's own distance the top speed is not reached; the factor keeps it from being exceeded.
  return at_speed_s >= kSpeedRamp_s ? at_speed_s + kSpeedRamp_s : 2 * at_speed_s;
}

double MotionProgram::cycle_s() const {
  double sum = 0;
  for (int i = loop_from; i < posture_count; ++i) sum += duration_s(i, after(i)) + hold_s;
  return sum;
}

bool MotionProgram::is_over(double program_s) const {
  if (loop_from + 1 < posture_count) return false;
  double end_s = 0;
  for (int i = 0; i < loop_from; ++i) end_s += duration_s(i, after(i)) + hold_s;
  return program_s >= end_s;
}

Joints MotionProgram::at(double program_s) const {
  if (posture_count == 0) return {};
  const double cycle = cycle_s();
  double left = program_s;
  bool looping = false;
  for (int i = 0;; i = after(i)) {
    if (i == loop_from && !looping) {
      if (loop_from == posture_count - 1 || cycle <= 0) break;
      left = std::fmod(left, cycle);
      looping = true;
    }
    const Joints& a = postures[static_cast<std::size_t>(i)];
    const Joints& b = postures[static_cast<std::size_t>(after(i))];
    const double duration = duration_s(i, after(i));
    if (left < duration) {
      const double s = profile == Profile::minimum_jerk ? minimum_jerk(left / duration)
                                                        : trapezoid(left, duration, ramp_of(duration));
      Joints q;
      for (std::size_t j = 0; j < kMaxJoints; ++j) q[j] = a[j] + s * (b[j] - a[j]);
      return q;
    }
    left -= duration;
    if (left < hold_s) return b;
    left -= hold_s;
  }
  return postures[static_cast<std::size_t>(loop_from)];
}

double MotionClock::rate_at(std::int64_t now_ns) const {
  const double t = static_cast<double>(now_ns - start_ns) * kSecondsPerNs;
  if (t <= 0) return rate_from;
  return t >= ramp_s ? rate_to : rate_from + (rate_to - rate_from) * t / ramp_s;
}

double MotionClock::time_at(std::int64_t now_ns) const {
  const double t = static_cast<double>(now_ns - start_ns) * kSecondsPerNs;
  // Before the change: at the rate it had, so that late reports of earlier moments stay what they were.
  if (t <= 0) return std::max(0.0, program_s + rate_from * t);
  if (t < ramp_s) return program_s + rate_from * t + 0.5 * (rate_to - rate_from) * t * t / ramp_s;
  return program_s + 0.5 * (rate_from + rate_to) * ramp_s + rate_to * (t - ramp_s);
}

Joints MotionPlan::positions_at(std::int64_t now_ns) const {
  if (commanded.count > 0) return commanded.at(now_ns);
  return now_ns < switch_ns ? current.at(now_ns) : next.at(now_ns);
}

Joints MotionPlan::velocities_at(std::int64_t now_ns) const {
  constexpr std::int64_t kHalfStep_ns = 500'000;
  const Joints before = positions_at(now_ns - kHalfStep_ns), after = positions_at(now_ns + kHalfStep_ns);
  Joints v;
  for (std::size_t j = 0; j < kMaxJoints; ++j) v[j] = (after[j] - before[j]) / (2e-9 * kHalfStep_ns);
  return v;
}

void MotionPlan::place(const Joints& posture, std::int64_t now_ns) {
  next = {};
  next.clock.start_ns = now_ns;
  next.program.posture_count = 1;
  next.program.postures[0] = posture;
  current = next;
  switch_ns = now_ns;
  commanded = {};
}

bool MotionPlan::is_running(std::int64_t now_ns) const {
  if (commanded.count > 0) return false;
  const bool rests = next.clock.rate_to == 0 && next.clock.rate_at(now_ns) == 0;
  return now_ns < switch_ns || (!rests && !next.program.is_over(next.clock.time_at(now_ns)));
}

/// Where the motion port has left the robot, its own programs begin.
void MotionPlan::end_commands(std::int64_t now_ns) {
  if (commanded.count > 0) place(commanded.at(now_ns), now_ns);
}

void MotionPlan::set_rate(double rate, std::int64_t now_ns) {
  end_commands(now_ns);
  const std::int64_t from_ns = std::max(now_ns, switch_ns);
  MotionClock& clock = next.clock;
  clock = {from_ns, clock.time_at(from_ns), clock.rate_at(from_ns), rate, kStopRamp_s};
}

void MotionPlan::visit(std::span<const Joints> postures, Profile profile, double speed_rad_s, double hold_s,
                       std::int64_t now_ns) {
  end_commands(now_ns);
  if (now_ns >= switch_ns) {
    set_rate(0, now_ns);
    current = next;
    switch_ns = now_ns + to_ns(kStopRamp_s);
  }
  MotionProgram program{static_cast<std::int32_t>(postures.size()) + 1, 1, profile, speed_rad_s, hold_s, {}};
  program.postures[0] = current.at(switch_ns);
  std::copy(postures.begin(), postures.end(), program.postures.begin() + 1);
  next = {{switch_ns, 0, 1, 1, 0}, program};
}

}  // namespace calibrd::sim
