// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/calibration_jobs.hpp"

#include <algorithm>

#include "api/problem/api_error.hpp"
#include "server/live_cell/calibration_job.hpp"
#include "server/live_cell/dated_id.hpp"

namespace calibrd {

using api::ApiError;
using api::CalibrationReport;
using api::JobStatus;

namespace {

/// `guess`: what the cell would start from.
std::optional<Pose> start_of(const api::CalibrationRequest& request, const std::optional<Pose>& guess) {
  if (request.guess_T_base_sensor || request.from_nothing) return request.guess_T_base_sensor;
  return guess;
}

}  // namespace

CalibrationJobs::CalibrationJobs(CalibrationStore& store, CalibrateFunction calibrate, Publish publish,
                                 Log log, JobSettings settings, Review review, EvidenceKeeper evidence)
    : store_(store),
      calibrate_(std::move(calibrate)),
      publish_(std::move(publish)),
      log_(std::move(log)),
      settings_(settings),
      review_(std::move(review)),
      evidence_(std::move(evidence)),
      thread_([this] { run(); }) {}

CalibrationJobs::~CalibrationJobs() {
  request_stop();
  join();
}

void CalibrationJobs::join() {
  if (thread_.joinable()) thread_.join();
}

void CalibrationJobs::request_stop() {
  const std::lock_guard lock(mutex_);
  is_stopping_ = true;
  for (const auto& [id, job] : jobs_) {
    job->cancelled = true;
    job->task->cancel();
  }
  changed_.notify_all();
}

Result<CalibrationReport> CalibrationJobs::start(const api::CalibrationRequest& request, LiveSensor& sensor,
                                                 const std::optional<Pose>& guess) {
  const std::lock_guard starting(starting_);
  const auto before = started_before(request);
  if (!before) return before.error();
  if (*before) return **before;
  if (const auto busy = active(sensor.id()); !busy.empty())
    return fail(ApiError::calibration_in_progress, busy);
  const auto start_pose = start_of(request, guess);
  if (!start_pose && request.method == Method::paper) return fail(ApiError::paper_needs_guess, sensor.id());
  if (request.postures && *request.postures < least_postures(start_pose))
    return fail(ApiError::guess_needed, sensor.id());
  const auto job = make_job(request, sensor, start_pose);
  if (auto added = store_.add(job->report, request); !added)
    return fail(ApiError::storage_failed, added.error().message());
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_) return fail(ApiError::shutting_down);
    jobs_[job->report.id] = job;
    job->report.status = JobStatus::collecting;
    changed_.notify_all();
  }
  sensor.feed(job->task);
  return find(job->report.id);
}

Result<std::optional<CalibrationReport>> CalibrationJobs::started_before(
    const api::CalibrationRequest& request) const {
  if (request.idempotency_key.empty()) return std::optional<CalibrationReport>();
  const auto start = store_.find_start(request.sensor_id, request.idempotency_key);
  if (!start) return fail(ApiError::storage_failed, start.error().message());
  if (!*start) return std::optional<CalibrationReport>();
  if ((*start)->fingerprint != request.fingerprint)
    return fail(ApiError::idempotency_conflict, "it started " + (*start)->calibration_id);
  const auto report = find((*start)->calibration_id);
  if (!report) return report.error();
  return std::optional<CalibrationReport>(*report);
}

CalibrationJobs::JobPointer CalibrationJobs::make_job(const api::CalibrationRequest& request,
                                                      LiveSensor& sensor, const std::optional<Pose>& guess) {
  auto job = std::make_shared<Job>();
  auto collector = settings_.collector;
  collector.postures = request.postures.value_or(collector.postures);
  // A robot at work must not be waited for while there is no pose.
  collector.moving_views = collector.moving_views || request.after_move;
  collector.postures = std::max(collector.postures, least_postures(guess));
  job->report.id = dated_id(std::chrono::system_clock::now(), random_);
  job->report.sensor_id = sensor.id();
  job->report.created = std::chrono::system_clock::now();
  job->report.method = request.method;
  job->report.postures_wanted = collector.postures;
  job->report.activate = request.activate;
  if (evidence_.describe) job->report.evidence = evidence_.describe({});
  job->request_id = log_marks().request_id;
  job->sensor = &sensor;
  job->guess = guess;
  job->deadline = Clock::now() + settings_.collect_timeout;
  if (request.patience) {
    const auto patience = std::chrono::duration_cast<Clock::duration>(*request.patience);
    job->patient_until = Clock::now() + patience;
    job->content_with_one_at = *job->patient_until + 3 * patience / 2;
  }
  job->task = std::make_shared<CollectTask>(
      collector,
      [this] {
        const std::lock_guard lock(mutex_);
        changed_.notify_all();
      },
      [this, id = job->report.id] { tell_of_drop(id); });
  return job;
}

Result<CalibrationReport> CalibrationJobs::find(const std::string& id) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto job = jobs_.find(id); job != jobs_.end()) return report_of(*job->second);
  }
  const auto stored = store_.find(id);
  if (!stored) return fail(ApiError::storage_failed, stored.error().message());
  if (!*stored) return fail(ApiError::no_such_calibration, id);
  return **stored;
}

Result<CalibrationReport> CalibrationJobs::cancel(const std::string& id) {
  JobPointer job;
  bool is_computing = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = jobs_.find(id); found != jobs_.end()) job = found->second;
    if (job && job->is_ending) return fail(ApiError::calibration_not_running, id);  // its end is being stored
    is_computing = job && job->report.status == JobStatus::running;
    if (job) job->cancelled = true;
  }
  if (!job) {
    const auto ended = find(id);
    return ended ? fail(ApiError::calibration_not_running, id) : ended.error();
  }
  job->task->cancel();
  // A computation sees the flag and ends by itself.
  if (!is_computing) end(job, JobStatus::cancelled, "Cancelled on request.");
  return find(id);
}

std::string CalibrationJobs::active(const std::string& sensor_id) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, job] : jobs_)
    if (job->report.sensor_id == sensor_id) return id;
  return {};
}

std::string CalibrationJobs::ended(const std::string& sensor_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = ended_.find(sensor_id);
  return found == ended_.end() ? std::string() : found->second;
}

void CalibrationJobs::tell_of_drop(const std::string& id) const {
  JobPointer job;
  std::optional<CalibrationReport> report;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = jobs_.find(id); found != jobs_.end()) job = found->second;
    if (job) report = report_of(*job);
  }
  if (!job) return;
  const LogScope scope(job->marks());
  log_(*report, {});
}

/// What the job is doing; the caller holds mutex_.
CalibrationReport CalibrationJobs::report_of(const Job& job) const {
  auto report = job.report;
  report.postures_seen = job.task->seen();
  if (report.status != JobStatus::collecting) return report;
  report.progress = kCollectingShare * job.task->most_seen() / report.postures_wanted;
  report.message =
      std::to_string(report.postures_seen) + " of " + std::to_string(report.postures_wanted) + " postures";
  report.message += dropped_postures(*job.task);
  const auto hindrance = job.sensor->hindrance();
  if (job.task->is_complete())
    report.message += "; waiting for another calibration to be computed";
  else if (!hindrance.empty())
    report.message += "; " + hindrance;
  else if (job.task->is_waiting_for_motion())
    report.message += "; move the robot to another posture and let it hold still";
  return report;
}

}  // namespace calibrd
