// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace calibrd::api {

/// Either `route` or `next_posture_of` with `approved_rad` is set.
struct MotionRequest {
  std::string route;                 ///< a list of postures of the configuration
  std::string next_posture_of;       ///< sensor whose suggested posture is to be taken …
  std::vector<double> approved_rad;  ///< … and the positions that whoever asks has seen and approves
};

enum class MotionStatus { running, stopping, succeeded, stopped, failed };

/// A motion of the robot, under way or ended. It succeeded exactly when every posture was visited.
struct MotionReport {
  std::string id;
  MotionStatus status = MotionStatus::running;
  std::string route, next_posture_of;  ///< as asked for; the other one is empty
  int postures = 0;
  int reached = 0;
  std::uint64_t commands = 0;  ///< sent to the robot
  std::string message;         ///< what it is doing, or why it ended and what to do
  std::chrono::system_clock::time_point created;
  std::optional<std::chrono::system_clock::time_point> finished;
};

struct MotionsReport {
  bool enabled = false;
  std::string hindrance;              ///< why no motion could be started now; empty: one could
  std::vector<std::string> routes;    ///< names
  std::vector<MotionReport> motions;  ///< newest first; since the daemon was started
};

}  // namespace calibrd::api
