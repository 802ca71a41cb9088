// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/timing/link_motion.hpp"
#include "server/live_cell/joint_history.hpp"

namespace calibrd {

/// A time offset that frames are paired with joints by, on top of the configured latencies.
struct AppliedOffset {
  Clock::duration value{0};
  double sigma_s = 0;  ///< of one frame: of the offset and of the stamps' jitter
};

/// How far (m) any point of the moving robot may be from where the joints at `exposed` put it, because the
/// moment is known to `sigma_s` only, messages around came late by d, the frame by `frame_delay_s`, and
/// joints are linear between two messages: v (σ + d + delay) + a T²/8 of the fastest point, T being the time
/// between the messages. Nothing where the joints around do not tell speed and acceleration.
std::optional<double> timing_error_m(const JointHistory& joints, const LinkReach& reach,
                                     Clock::time_point exposed, double sigma_s, double frame_delay_s);

/// How far (m) the joints around may put any point of the robot wrong only because messages, or the frame,
/// came late: v (d + delay).
double late_error_m(const JointHistory& joints, const LinkReach& reach, Clock::time_point exposed,
                    double frame_delay_s);

}  // namespace calibrd
