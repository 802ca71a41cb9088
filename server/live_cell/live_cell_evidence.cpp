// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of LiveCell that keeps what calibrations were made from.
#include "api/problem/api_error.hpp"
#include "server/live_cell/frame_average.hpp"
#include "server/live_cell/live_cell.hpp"
#include "server/recording/record.hpp"

namespace calibrd {

using api::ApiError;

EvidenceKeeper LiveCell::evidence_keeper() {
  EvidenceKeeper keeper;
  keeper.describe = [this](std::span<const View> views) {
    api::Evidence evidence{settings_.version, settings_.configuration, robot_.model().position_names(), {}};
    for (const View& view : views) evidence.views.push_back({view.stamp_s, view.joint_positions_rad});
    return evidence;
  };
  keeper.keep_views = [this](const auto& calibration, auto& sensor, auto views) {
    keep_views(calibration, sensor, views);
  };
  return keeper;
}

/// A calibration without its views is one all the same.
void LiveCell::keep_views(const api::CalibrationReport& calibration, const LiveSensor& sensor,
                          std::span<const View> views) const {
  const auto& captures = settings_.captures;
  if (!captures || !captures->keeps_any()) return;
  const auto tar = archive(sensor, views, "views of calibration " + calibration.id);
  const auto kept = tar ? captures->keep(calibration.id, tar->tar) : Status(tar.error());
  if (!kept && log_.on_error)
    log_.on_error("the views of calibration " + calibration.id + " are not kept: " + kept.error().message());
}

Result<api::CaptureArchive> LiveCell::archive(const LiveSensor& sensor, std::span<const View> views,
                                              const std::string& note) const {
  Capture capture;
  capture.note = note;
  capture.urdf = settings_.urdf;
  capture.base_link = settings_.base_link;
  capture.joint_names = robot_.model().position_names();
  capture.sensor_id = sensor.id();
  capture.camera = sensor.camera();
  capture.views.assign(views.begin(), views.end());
  bring_to_one_unit(capture.views);
  const auto scratch =
      settings_.captures ? settings_.captures->scratch() : std::filesystem::temp_directory_path();
  return archive_capture(capture, settings_.search_paths, scratch);
}

Result<api::CalibrationReport> LiveCell::calibration(std::string_view id) const {
  auto found = jobs_.find(std::string(id));
  if (found && settings_.captures) found->capture_bytes = settings_.captures->size(found->id);
  return found;
}

Result<api::CaptureArchive> LiveCell::calibration_capture(std::string_view id) const {
  const auto found = calibration(id);
  if (!found) return found.error();
  if (!found->capture_bytes) return fail(ApiError::capture_not_kept, found->id);
  auto tar = settings_.captures->read(found->id);
  if (!tar) return fail(ApiError::storage_failed, tar.error().message());
  return api::CaptureArchive{found->id + ".tar", *std::move(tar)};
}

}  // namespace calibrd
