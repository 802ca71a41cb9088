// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/json/object.hpp>

#include "api/json/strict_object.hpp"
#include "api/routes/cloud_response.hpp"
#include "api/routes/header_numbers.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"
#include "api/routes/shared_answers.hpp"

namespace calibrd::api {
namespace {

constexpr int kMaxPostures = 50;
constexpr double kMaxTimeout_s = 600;

Result<CaptureRequest> read_capture_request(const Request& request, const std::string& sensor_id) {
  const auto body =
      read_body(request.body, request.header("content-type"), {"postures", "timeout_s", "note"});
  if (!body) return body.error();
  const auto postures = read_int(*body, "postures", 1, kMaxPostures);
  if (!postures) return postures.error();
  const auto timeout_s = read_number(*body, "timeout_s", 0.1, kMaxTimeout_s);
  if (!timeout_s) return timeout_s.error();
  const auto note = read_text(*body, "note", 4096);
  if (!note) return note.error();
  return CaptureRequest{sensor_id, postures->value_or(1), Seconds(timeout_s->value_or(30)),
                        note->value_or("")};
}

Response answer_capture(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto wanted = read_capture_request(request, values[0]);
  return wanted ? archive_response(service.record_capture(*wanted)) : problem(wanted.error());
}

/// What a cloud was made from, as name and value.
std::vector<std::pair<std::string, std::string>> provenance(const Cloud& cloud) {
  std::vector<std::pair<std::string, std::string>> lines{{"Calibrd-Frame", cloud.frame}};
  if (cloud.joint_stamp_ns)
    lines.emplace_back("Calibrd-Joint-Stamp-Ns", std::to_string(*cloud.joint_stamp_ns));
  if (!cloud.joint_positions_rad.empty())
    lines.emplace_back("Calibrd-Joint-Positions", numbers_text(cloud.joint_positions_rad));
  if (cloud.frame_stamp_ns)
    lines.emplace_back("Calibrd-Frame-Stamp-Ns", std::to_string(*cloud.frame_stamp_ns));
  if (cloud.T_base_sensor) {
    lines.emplace_back("Calibrd-T-Base-Sensor", pose_text(*cloud.T_base_sensor));
    lines.emplace_back("Calibrd-Pose-Valid", cloud.pose_valid ? "true" : "false");
  }
  return lines;
}

Response answer_cloud(CloudKind kind, const Request& request, const PathValues& values,
                      CellService& service) {
  if (auto unknown = unknown_query(request, {"frame", "format"})) return problem(*unknown);
  const auto frame = request.query.find("frame");
  const bool in_base = frame != request.query.end() && frame->second == "base";
  if (frame != request.query.end() && !in_base && frame->second != "sensor")
    return problem(ApiError::bad_query,
                   "frame: \"" + frame->second + "\" is neither \"sensor\" nor \"base\"");
  const auto format = read_cloud_format(request);
  if (!format) return problem(format.error());
  const auto cloud = service.cloud({values[0], kind, in_base});
  if (!cloud) return problem(cloud.error());
  return cloud_response(*format, {cloud->points, cloud->residual_m, {}}, provenance(*cloud));
}

}  // namespace

void add_recording_routes(Router& router, CellService& service) {
  router.add("POST", "/api/v1/sensors/{id}/captures", Scope::calibrate, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_capture(request, values, service);
             });
  router.add("GET", "/api/v1/calibrations/{id}/capture", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               if (auto unknown = unknown_query(request, {})) return problem(*unknown);
               return archive_response(service.calibration_capture(values[0]));
             });
  constexpr std::array kKinds{std::pair{"measured", CloudKind::measured},
                              std::pair{"virtual", CloudKind::virtual_},
                              std::pair{"residual", CloudKind::residual}};
  const auto shared = std::make_shared<SharedAnswers>();
  for (const auto& [name, kind] : kKinds)
    router.add("GET", std::string("/api/v1/sensors/{id}/clouds/") + name, Scope::read, Cost::slow,
               [&service, shared, kind = kind](const Request& request, const PathValues& values) {
                 return shared->get(request, [&] { return answer_cloud(kind, request, values, service); });
               });
}

}  // namespace calibrd::api
