// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <optional>

#include "core/base/log_scope.hpp"
#include "server/live_cell/calibration_jobs.hpp"

namespace calibrd {

/// Of the progress of a job: collecting takes it here, computing from here to 1.
inline constexpr double kCollectingShare = 0.5;

/// Without a guess the sensor is found from what moves between two postures.
inline int least_postures(const std::optional<Pose>& guess) { return guess ? 1 : 2; }

/// One calibration under way. Report and flags are guarded by the mutex of CalibrationJobs.
struct CalibrationJobs::Job {
  api::CalibrationReport report;
  LiveSensor* sensor = nullptr;
  std::optional<Pose> guess;
  std::shared_ptr<CollectTask> task;
  Clock::time_point deadline;                      ///< of collecting
  std::optional<Clock::time_point> patient_until;  ///< then two postures are enough ...
  Clock::time_point content_with_one_at;           ///< ... and then whatever has been seen
  Clock::time_point seen_at;                       ///< when the last of its views was taken
  Surroundings surroundings;                       ///< that its views show, once it is accepted
  std::atomic<bool> cancelled{false};
  bool is_ending = false;  ///< its end is being stored
  std::string request_id;  ///< of whoever asked for it; empty: nobody did

  /// For what is logged of it: it belongs to the request being answered, else to the one that asked for the
  /// job.
  LogMarks marks() const {
    const auto now = log_marks().request_id;
    return {now.empty() ? std::string_view(request_id) : now, report.id};
  }
};

}  // namespace calibrd
