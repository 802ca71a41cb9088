// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What LiveCell is asked for besides poses and calibrations: history, the next posture, recordings, clouds.
#include "api/problem/api_error.hpp"
#include "server/live_cell/live_cell.hpp"
#include "server/recording/record.hpp"

namespace calibrd {

using api::ApiError;

Result<api::HistoryPage> LiveCell::history(const api::HistoryQuery& query) const {
  if (const auto entry = find(query.sensor_id); !entry) return entry.error();
  if (!query.before.empty()) {
    const auto before = store_.find(query.before);
    if (!before) return fail(ApiError::storage_failed, before.error().message());
    if (!*before || (*before)->sensor_id != query.sensor_id)
      return fail(ApiError::bad_query,
                  "before: " + query.before + " is no calibration of " + query.sensor_id);
  }
  auto page = store_.history(query);
  if (!page) return fail(ApiError::storage_failed, page.error().message());
  for (auto& calibration : page->calibrations)
    if (!calibration.finished)
      if (auto live = jobs_.find(calibration.id)) calibration = *std::move(live);
  return page;
}

Result<std::vector<WorkspacePoint>> LiveCell::workspace(std::string_view sensor_id) const {
  const auto entry = find(sensor_id);
  if (!entry) return entry.error();
  return (*entry)->sensor->workspace();
}

Result<PostureSuggestion> LiveCell::next_posture(const api::NextPostureRequest& request) const {
  const auto entry = find(request.sensor_id);
  if (!entry) return entry.error();
  const auto evidence = (*entry)->sensor->evidence();
  if (!evidence) {
    const auto pose = (*entry)->sensor->pose();
    return pose.known ? fail(ApiError::calibrate_first, request.sensor_id + ": " + pose.reason)
                      : fail(ApiError::no_pose, request.sensor_id);
  }
  PlanningSettings planning;
  planning.min_height_m = request.table_height_m;
  planning.min_change_rad = settings_.jobs.collector.min_distance_rad;
  auto suggestion = suggest_posture(virtual_cell_, (*entry)->setup.camera, evidence->T_base_sensor,
                                    evidence->covariance, evidence->postures, planning);
  if (!suggestion) return fail(ApiError::no_posture, request.sensor_id);
  motions_.remember(request.sensor_id, *suggestion);
  return *std::move(suggestion);
}

Result<std::vector<View>> LiveCell::collect(Entry& entry, const api::CaptureRequest& request) {
  auto collector = settings_.jobs.collector;
  collector.postures = request.postures;
  collector.frames_per_posture = 1;  // a recording holds what the sensor delivered
  collector.moving_views = false;    // ... and cannot tell how well its joints are known
  const auto task = std::make_shared<CollectTask>(collector);
  {
    const std::lock_guard lock(entry.recording);
    if (is_stopping_) return fail(ApiError::shutting_down);
    if (entry.recording_task) return fail(ApiError::capture_in_progress, entry.setup.id);
    entry.recording_task = task;
  }
  entry.sensor->feed(task);
  const bool complete =
      task->wait_until(Clock::now() + std::chrono::duration_cast<Clock::duration>(request.timeout));
  task->cancel();
  {
    const std::lock_guard lock(entry.recording);
    entry.recording_task.reset();
  }
  if (complete) return task->take_views();
  if (is_stopping_) return fail(ApiError::shutting_down);
  const auto hindrance = entry.sensor->hindrance();
  return fail(ApiError::postures_not_seen,
              std::to_string(task->seen()) + " of " + std::to_string(request.postures) + " postures" +
                  dropped_postures(*task) + (hindrance.empty() ? "" : "; " + hindrance));
}

Result<api::CaptureArchive> LiveCell::record_capture(const api::CaptureRequest& request) {
  const auto entry = find(request.sensor_id);
  if (!entry) return entry.error();
  const auto views = collect(**entry, request);
  if (!views) return views.error();
  return archive(*(*entry)->sensor, *views, request.note);
}

Result<api::Cloud> LiveCell::cloud(const api::CloudRequest& request) const {
  const auto entry = find(request.sensor_id);
  if (!entry) return entry.error();
  return clouds_.make(request, *(*entry)->sensor, (*entry)->setup.guess_T_base_sensor);
}

Result<std::optional<api::SensorFrame>> LiveCell::sensor_frame(const api::SensorFrameRequest& request) const {
  const auto entry = find(request.sensor_id);
  if (!entry) return entry.error();
  return frames_.make(request, *(*entry)->sensor, (*entry)->setup.guess_T_base_sensor);
}

Result<TriangleMesh> LiveCell::link_surface(std::string_view link) const {
  const auto index = robot_.model().find_link(link);
  if (!index) return fail(ApiError::no_such_link, std::string(link));
  return robot_.model().links()[static_cast<std::size_t>(*index)].surface;
}

}  // namespace calibrd
