// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd::api {

/// Everything the HTTP interface can refuse. Each has a stable `code`, a status and a remedy: see
/// problem_entry().
enum class ApiError {
  bad_request = 1,
  no_such_route,
  method_not_allowed,
  no_such_sensor,
  no_such_calibration,
  capture_not_kept,
  bad_query,
  unknown_format,
  wrong_content_type,
  bad_json,
  unknown_key,
  bad_value,
  bad_idempotency_key,
  idempotency_conflict,
  pose_not_valid,
  no_controller_frame,
  no_pose,
  no_posture,
  calibrate_first,
  no_frame,
  no_joints,
  joints_stale,
  calibration_in_progress,
  calibration_not_running,
  calibration_not_finished,
  not_activatable,
  not_comparable,
  guess_needed,
  paper_needs_guess,
  capture_in_progress,
  postures_not_seen,
  motion_disabled,
  motion_not_possible,
  motion_in_progress,
  motion_ended,
  way_refused,
  posture_not_suggested,
  no_such_motion,
  no_such_motion_route,
  no_such_link,
  storage_failed,
  capture_failed,
  header_too_large,
  body_too_large,
  too_many_connections,
  too_many_requests,
  token_needed,
  token_unknown,
  scope_too_small,
  wrong_host,
  wrong_origin,
  shutting_down,
  internal,
};

/// One row of the table of problems.
struct ProblemEntry {
  int status;
  const char* code;    ///< stable: programs may depend on it
  const char* title;   ///< what is wrong
  const char* remedy;  ///< what to do next
};

const ProblemEntry& problem_entry(ApiError error);

const std::error_category& api_category();
std::error_code make_error_code(ApiError error);

inline Error fail(ApiError error, std::string detail = {}) {
  return {make_error_code(error), std::move(detail)};
}

}  // namespace calibrd::api

template <>
struct std::is_error_code_enum<calibrd::api::ApiError> : std::true_type {};
