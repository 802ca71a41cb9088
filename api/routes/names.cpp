// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/names.hpp"

#include <array>
#include <cstdio>

#include "core/base/utc_text.hpp"

namespace calibrd::api {

const char* name_of(PoseState state) {
  switch (state) {
    case PoseState::uncalibrated:
      return "uncalibrated";
    case PoseState::calibrated:
      return "calibrated";
    case PoseState::unverified:
      return "unverified";
    case PoseState::drifted:
      return "drifted";
  }
  return "unverified";
}

const char* name_of(JobStatus status) {
  switch (status) {
    case JobStatus::queued:
      return "queued";
    case JobStatus::collecting:
      return "collecting";
    case JobStatus::running:
      return "running";
    case JobStatus::succeeded:
      return "succeeded";
    case JobStatus::failed:
      return "failed";
    case JobStatus::cancelled:
      return "cancelled";
  }
  return "failed";
}

const char* name_of(MotionStatus status) {
  switch (status) {
    case MotionStatus::running:
      return "running";
    case MotionStatus::stopping:
      return "stopping";
    case MotionStatus::succeeded:
      return "succeeded";
    case MotionStatus::stopped:
      return "stopped";
    case MotionStatus::failed:
      return "failed";
  }
  return "failed";
}

std::string rfc3339(SystemTime time) {
  const auto ms = std::chrono::floor<std::chrono::milliseconds>(time);
  const auto fraction = ms - std::chrono::floor<std::chrono::seconds>(ms);
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), ".%03dZ", static_cast<int>(fraction.count()));
  return utc_text(time, kUtcSeconds) + end.data();
}

}  // namespace calibrd::api
