// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/calibration/view.hpp"

namespace calibrd {

/// One frame and what is known of the robot at its time.
struct Sighting {
  View view;                  ///< joint_positions_rad empty when the joints of the frame's time are not known
  Clock::time_point stamp;    ///< when the frame arrived
  Clock::time_point exposed;  ///< the moment its joints are of: the stamp less latency and time offset
  /// See FrameDecision: how far the robot may be from where these joints put it (m, 1 sigma).
  std::optional<double> timing_error_m = std::nullopt;
};

}  // namespace calibrd
