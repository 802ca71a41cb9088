// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/problem/api_error.hpp"

#include <array>
#include <string>

namespace calibrd::api {
namespace {

struct Row {
  ApiError error;
  ProblemEntry entry;
};

// clang-format off
constexpr std::array kTable{
    Row{ApiError::bad_request, {400, "bad_request", "The request is not valid HTTP.", "Send a well-formed HTTP/1.1 request, as every HTTP library does; docs/security.md lists what is refused."}},
    Row{ApiError::no_such_route, {404, "not_found", "There is nothing at this path.", "Check the path against docs/api.md."}},
    Row{ApiError::method_not_allowed, {405, "method_not_allowed", "This path does not take this method.", "Use one of the methods in the Allow header."}},
    Row{ApiError::no_such_sensor, {404, "no_such_sensor", "No sensor has this id.", "Use an id of GET /api/v1/sensors."}},
    Row{ApiError::no_such_link, {404, "no_such_link", "No link of the robot has this name.", "Use the name of a link of GET /api/v1/robot."}},
    Row{ApiError::no_such_calibration, {404, "no_such_calibration", "No calibration has this id.", "Use an id of GET /api/v1/sensors/{id}/calibrations."}},
    Row{ApiError::capture_not_kept, {404, "capture_not_kept", "The views of this calibration are not kept.", "Raise storage.captures_max_age or storage.captures_max_mb for those to come."}},
    Row{ApiError::bad_query, {400, "bad_query", "A query parameter cannot be used.", "Correct the parameter that is named."}},
    Row{ApiError::unknown_format, {400, "unknown_format", "No such pose format.", "Use one of the formats that are named."}},
    Row{ApiError::wrong_content_type, {415, "wrong_content_type", "The body must be JSON.", "Send the header Content-Type: application/json."}},
    Row{ApiError::bad_json, {400, "bad_json", "The body is not valid JSON.", "Correct the body at the place that is named."}},
    Row{ApiError::unknown_key, {400, "unknown_key", "The body holds a key that does not exist.", "Correct the key or remove it."}},
    Row{ApiError::bad_value, {400, "bad_value", "A value in the body cannot be used.", "Correct the value that is named."}},
    Row{ApiError::bad_idempotency_key, {400, "bad_idempotency_key", "The Idempotency-Key cannot be used.", "Send 1 to 128 printable ASCII characters."}},
    Row{ApiError::idempotency_conflict, {422, "idempotency_conflict", "This Idempotency-Key was used with another request.", "Use a new key for a new request."}},
    Row{ApiError::pose_not_valid, {409, "pose_not_valid", "There is no pose that may be used now.", "Look at state and last_known of the pose without ?format=; calibrate when it is uncalibrated or drifted."}},
    Row{ApiError::no_controller_frame, {409, "no_controller_frame", "It is not configured which link the robot controller calls its base.", "Set robot.controller_frame to that link of the URDF (docs/pose_formats.md) and start again, or use a format that is given in the base frame."}},
    Row{ApiError::no_pose, {409, "no_pose", "The pose of this sensor is not known at all.", "Calibrate the sensor, or configure a guess for it."}},
    Row{ApiError::no_posture, {409, "no_posture", "No posture was found that the robot may take in the sensor's view.", "Lower table_height_m, or move the sensor so that it sees more of the robot's reach."}},
    Row{ApiError::calibrate_first, {409, "calibrate_first", "The last pose of this sensor is drifted or withheld: a posture chosen from it could help nothing.", "Calibrate the sensor, then ask again; an uncertain result is enough."}},
    Row{ApiError::no_frame, {503, "no_frame", "The sensor has no current frame.", "Look at health of the sensor; its reason says what to do."}},
    Row{ApiError::no_joints, {503, "no_joints", "The robot controller has sent no joint positions.", "Look at link of GET /api/v1/robot; its reason says what to do."}},
    Row{ApiError::joints_stale, {503, "joints_stale", "The joint positions are stale.", "Look at link of GET /api/v1/robot; its reason says what to do."}},
    Row{ApiError::calibration_in_progress, {409, "calibration_in_progress", "A calibration of this sensor is under way.", "Wait for it, or cancel it with DELETE."}},
    Row{ApiError::calibration_not_running, {409, "calibration_not_running", "This calibration has ended; it cannot be cancelled.", "Read its result with GET."}},
    Row{ApiError::calibration_not_finished, {409, "calibration_not_finished", "This calibration has not ended yet.", "Wait until its status is succeeded."}},
    Row{ApiError::not_activatable, {409, "not_activatable", "Only an accepted calibration can become the current pose.", "Choose one with verdict accepted."}},
    Row{ApiError::not_comparable, {409, "not_comparable", "These calibrations cannot be compared.", "Choose two calibrations of one sensor whose results have a pose: accepted or uncertain ones."}},
    Row{ApiError::guess_needed, {409, "guess_needed", "One posture is not enough to find the sensor from nothing.", "Ask for at least two postures, or give a guess."}},
    Row{ApiError::paper_needs_guess, {409, "paper_needs_guess", "The method \"paper\" cannot start from nothing.", "Give a guess (more postures do not help), configure one for the sensor, or use the method \"full\"."}},
    Row{ApiError::capture_in_progress, {409, "capture_in_progress", "A capture of this sensor is under way.", "Wait for it to end."}},
    Row{ApiError::postures_not_seen, {409, "postures_not_seen", "The robot did not hold still in enough different postures.", "Move the robot, ask for fewer postures or a longer timeout_s; views of the sensor says why frames are not used."}},
    Row{ApiError::motion_disabled, {403, "motion_disabled", "This daemon does not move the robot.", "Set motion.enabled, if it shall; read docs/motion.md first."}},
    Row{ApiError::motion_not_possible, {409, "motion_not_possible", "The robot must not be moved now.", "Do what the detail says, then ask again."}},
    Row{ApiError::motion_in_progress, {409, "motion_in_progress", "A motion is under way.", "Wait for it, or stop it with DELETE."}},
    Row{ApiError::motion_ended, {409, "motion_ended", "This motion has ended; it cannot be stopped.", "Read how it ended with GET."}},
    Row{ApiError::way_refused, {409, "way_refused", "A posture, or the way there, is none the robot may take.", "Teach other postures, or a posture between; check motion.table_height_m."}},
    Row{ApiError::posture_not_suggested, {409, "posture_not_suggested", "What is approved is not the posture last suggested for this sensor.", "Ask GET /api/v1/sensors/{id}/next-posture, look at it, and approve its positions_rad."}},
    Row{ApiError::no_such_motion, {404, "no_such_motion", "No motion has this id.", "Use an id of GET /api/v1/robot/motions; those of before a restart are gone."}},
    Row{ApiError::no_such_motion_route, {404, "no_such_motion_route", "No list of postures has this name.", "Use a name of routes of GET /api/v1/robot/motions, or add motion.routes.NAME to the configuration."}},
    Row{ApiError::storage_failed, {500, "storage_failed", "The calibration store failed.", "Check disk space and permissions of storage.path; the log names the fault."}},
    Row{ApiError::capture_failed, {500, "capture_failed", "The capture could not be written.", "Check disk space and permissions of the folder of storage.path."}},
    Row{ApiError::header_too_large, {431, "header_too_large", "The request header is too large.", "Send at most 8 KiB of header."}},
    Row{ApiError::body_too_large, {413, "body_too_large", "The request body is too large.", "Send at most 64 KiB."}},
    Row{ApiError::too_many_connections, {503, "too_many_connections", "Too many connections are open.", "Reuse connections, or raise server.max_connections."}},
    Row{ApiError::too_many_requests, {429, "too_many_requests", "Too many requests come from this address.", "Ask less often, or with ?wait= or If-None-Match, or raise server.rate_limit (server.loopback_rate_limit on the same machine)."}},
    Row{ApiError::token_needed, {401, "token_needed", "This daemon answers only clients with a token.", "Send the header Authorization: Bearer TOKEN; whoever runs the daemon makes one with `calibrd token create`."}},
    Row{ApiError::token_unknown, {401, "token_unknown", "This token is not known here.", "Send a token of this daemon, as Authorization: Bearer TOKEN; it may have been revoked: `calibrd token list`."}},
    Row{ApiError::scope_too_small, {403, "scope_too_small", "This token does not allow this.", "Use a token with the scope that is named: `calibrd token create NAME --scope SCOPE`."}},
    Row{ApiError::wrong_host, {421, "wrong_host", "This daemon does not go by the name of the Host header.", "Use its address or localhost, or add the name to server.hosts."}},
    Row{ApiError::wrong_origin, {403, "wrong_origin", "A page of another site must not speak to this daemon.", "Ask from a program, or from a page under the daemon's own name; a proxy must pass the Host header on, or its name be in server.hosts."}},
    Row{ApiError::shutting_down, {503, "shutting_down", "The daemon is ending.", "Try again when it has been started again."}},
    Row{ApiError::internal, {500, "internal", "Something unexpected went wrong.", "Report it with the log of the daemon around this time."}},
};
// clang-format on

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "api"; }
  std::string message(int code) const override {
    const auto& entry = problem_entry(static_cast<ApiError>(code));
    return std::string(entry.title) + " " + entry.remedy;
  }
};

}  // namespace

const ProblemEntry& problem_entry(ApiError error) {
  for (const auto& row : kTable)
    if (row.error == error) return row.entry;
  return kTable.back().entry;
}

const std::error_category& api_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(ApiError error) { return {static_cast<int>(error), api_category()}; }

}  // namespace calibrd::api
