// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The part of CalibrationJobs that runs on its thread, and the end of every job.
#include <algorithm>
#include <exception>

#include "server/live_cell/calibration_job.hpp"

namespace calibrd {

using api::CalibrationReport;
using api::JobStatus;

namespace {

constexpr auto kLongWait = std::chrono::hours(1);
constexpr auto kImpatience = std::chrono::milliseconds(50);  // how often is looked whether a posture has come

constexpr const char* kCancelled = "Cancelled on request.";

/// What a quick attempt must know of the pose: the few views of one lie beyond twice their sigma now and
/// then, and 5 mm are too much to be served as good.
constexpr double kQuickSigma_m = 0.002, kQuickSigma_rad = 0.002;

void hold_to_quick_limits(CalibrationResult& result) {
  if (result.verdict != Verdict::accepted) return;
  if (result.sigma_position_m <= kQuickSigma_m && result.sigma_rotation_rad <= kQuickSigma_rad) return;
  result.verdict = Verdict::uncertain;
  const bool is_position = result.sigma_position_m > kQuickSigma_m;
  result.reasons.push_back({is_position ? "position_uncertain" : "rotation_uncertain",
                            "the few views of a quick attempt tell less than 2 mm and 2 mrad; more follow"});
}

bool is_accepted(const CalibrationResult& result) {
  return result.verdict == Verdict::accepted && result.T_base_sensor;
}

/// Why a calibration without an accepted result has failed, from its reasons.
std::string failure_message(const CalibrationResult& result) {
  std::string message =
      result.verdict == Verdict::uncertain ? "The result is uncertain" : "The result was rejected";
  for (std::size_t i = 0; i < result.reasons.size(); ++i)
    message += (i == 0 ? ": " : "; ") + result.reasons[i].text;
  return message + ".";
}

Clock::time_point time_of_last(std::span<const View> views) {
  const std::chrono::duration<double> stamp(views.back().stamp_s);
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(stamp));
}

/// What a result says of the pose, for choosing the next posture; the paper's method says too little.
std::optional<PoseEvidence> evidence_of(const CalibrationResult& result, Method method,
                                        std::span<const View> views) {
  if (!result.T_base_sensor || method == Method::paper) return std::nullopt;
  PoseEvidence evidence{*result.T_base_sensor, result.covariance, {}};
  for (const View& view : views) evidence.postures.push_back(view.joint_positions_rad);
  return evidence;
}

}  // namespace

/// When to see whether a job has waited long enough.
static Clock::time_point next_look(const std::optional<Clock::time_point>& patient_until) {
  return patient_until ? std::max(*patient_until, Clock::now() + kImpatience) : Clock::time_point::max();
}

void CalibrationJobs::run() {
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    end_patience(Clock::now());
    const auto overdue = take_overdue(Clock::now());
    const auto ready = next_ready();
    if (ready) begin_computing(*ready);
    if (overdue.empty() && !ready) {
      auto wake = Clock::now() + kLongWait;
      for (const auto& [id, job] : jobs_)
        if (job->task->is_open()) wake = std::min({wake, job->deadline, next_look(job->patient_until)});
      changed_.wait_until(lock, wake);
      continue;
    }
    lock.unlock();
    for (const auto& job : overdue) end_overdue(job);
    if (ready) compute_safely(ready);
    lock.lock();
  }
}

/// Jobs that would rather begin than wait; the caller holds mutex_.
void CalibrationJobs::end_patience(Clock::time_point now) {
  for (const auto& [id, job] : jobs_) {
    if (!job->patient_until || now < *job->patient_until || !job->task->is_open()) continue;
    const int least = least_postures(job->guess);  // one tells little: another may be on its way
    job->task->settle_for_less(now < job->content_with_one_at ? std::max(2, least) : least);
  }
}

/// The caller holds mutex_.
void CalibrationJobs::begin_computing(Job& job) {
  job.report.status = JobStatus::running;
  job.report.progress = kCollectingShare;
}

/// The oldest job that has its postures; the caller holds mutex_.
CalibrationJobs::JobPointer CalibrationJobs::next_ready() {
  JobPointer oldest;
  for (const auto& [id, job] : jobs_) {
    if (job->report.status != JobStatus::collecting || job->is_ending || !job->task->is_complete()) continue;
    if (!oldest || job->report.created < oldest->report.created) oldest = job;
  }
  return oldest;
}

/// Jobs that have not seen their postures in time; the caller holds mutex_.
std::vector<CalibrationJobs::JobPointer> CalibrationJobs::take_overdue(Clock::time_point now) {
  std::vector<JobPointer> overdue;
  for (const auto& [id, job] : jobs_)
    if (job->report.status == JobStatus::collecting && !job->is_ending && job->task->is_open() &&
        now >= job->deadline)
      overdue.push_back(job);
  return overdue;
}

void CalibrationJobs::end_overdue(const JobPointer& job) {
  job->task->cancel();
  const auto seen = std::to_string(job->task->seen()), wanted = std::to_string(job->report.postures_wanted);
  auto message = "Only " + seen + " of " + wanted + " postures within calibration.collect_timeout" +
                 dropped_postures(*job->task) + ". Move the robot, or ask for fewer postures.";
  if (const auto hindrance = job->sensor->hindrance(); !hindrance.empty())
    message += " Last: " + hindrance + ".";
  end(job, JobStatus::failed, std::move(message));
}

/// Whatever goes wrong costs this job, not the daemon.
void CalibrationJobs::compute_safely(const JobPointer& job) {
  try {
    compute(job);
  } catch (const std::exception& failure) {
    end(job, JobStatus::failed, std::string("The calibration failed unexpectedly: ") + failure.what());
  }
}

void CalibrationJobs::compute(const JobPointer& job) {
  const LogScope scope(job->marks());
  const auto views = job->task->take_views();
  const auto seen_at = time_of_last(views);
  auto made_from = evidence_.describe ? std::optional(evidence_.describe(views)) : std::nullopt;
  {
    const std::lock_guard lock(mutex_);
    job->seen_at = seen_at;
    job->report.evidence = std::move(made_from);
  }
  auto result = calibrate(job, views);
  if (job->patient_until) hold_to_quick_limits(result);
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_) return;  // the store calls it interrupted when it is opened again
  }
  if (job->cancelled) {
    end(job, JobStatus::cancelled, kCancelled);
    return;
  }
  if (review_ && is_accepted(result)) {
    auto surroundings = review_(*job->sensor, views, result);
    const std::lock_guard lock(mutex_);
    job->surroundings = std::move(surroundings);
  }
  auto evidence = evidence_of(result, job->report.method, views);
  end_computed(job, std::move(result));
  if (evidence) job->sensor->set_evidence(*std::move(evidence), seen_at);
  if (evidence_.keep_views) evidence_.keep_views(job->report, *job->sensor, views);
}

CalibrationResult CalibrationJobs::calibrate(const JobPointer& job, std::span<const View> views) {
  CalibrationSettings settings;
  settings.method = job->report.method;
  settings.guess_T_base_sensor = job->guess;
  settings.workspace = job->sensor->workspace();
  settings.cancelled = &job->cancelled;
  settings.on_progress = [&](double share) {
    const std::lock_guard lock(mutex_);
    const double progress = kCollectingShare + (1 - kCollectingShare) * std::clamp(share, 0.0, 1.0);
    job->report.progress = std::max(job->report.progress, progress);  // a computation may begin once more
  };
  try {
    return calibrate_(job->sensor->camera(), views, settings);
  } catch (const std::exception& failure) {
    CalibrationResult result;
    result.reasons.push_back(
        {"internal", std::string("the computation failed unexpectedly: ") + failure.what()});
    return result;
  }
}

void CalibrationJobs::end_computed(const JobPointer& job, CalibrationResult result) {
  const bool accepted = is_accepted(result);
  auto message = accepted ? std::string() : failure_message(result);
  end(job, accepted ? JobStatus::succeeded : JobStatus::failed, std::move(message), std::move(result));
}

/// Stores the end first: a pose that is not on the disk is not published.
void CalibrationJobs::end(const JobPointer& job, JobStatus status, std::string message,
                          std::optional<CalibrationResult> result) {
  const LogScope scope(job->marks());
  CalibrationReport report;
  Clock::time_point seen_at;
  Surroundings surroundings;
  {
    const std::lock_guard lock(mutex_);
    if (job->is_ending) return;
    job->is_ending = true;  // who cancels from now on is told that it is too late
    if (job->cancelled && !is_stopping_ && status == JobStatus::succeeded) {
      status = JobStatus::cancelled;
      message = kCancelled;
      result.reset();
    }
    report = job->report;
    seen_at = job->seen_at;
    surroundings = job->surroundings;
  }
  report.status = status;
  report.message = std::move(message);
  report.result = std::move(result);
  report.finished = std::chrono::system_clock::now();
  report.progress = 1;
  report.postures_seen = job->task->seen();
  if (store_end(report, job->sensor->basis()) && status == JobStatus::succeeded)
    publish_(report, seen_at, surroundings);
  log_(report, seen_at);
  const std::lock_guard lock(mutex_);
  jobs_.erase(report.id);
  ended_[report.sensor_id] = report.id;
}

/// Stores the end, and that it is current now if it is to be. False: it could not be stored; a pose that is
/// not on the disk is none.
bool CalibrationJobs::store_end(CalibrationReport& report, const std::string& basis) {
  const bool activate = report.status == JobStatus::succeeded && report.activate;
  const auto stored = store_.finish(report, activate ? std::optional(basis) : std::nullopt);
  report.current = stored && activate;
  if (stored) return true;
  if (report.status == JobStatus::succeeded) {
    report.status = JobStatus::failed;
    report.message = "It would have been accepted, and the pose before it stays.";
    report.result.reset();
  }
  report.message = "The result could not be stored: " + stored.error().message() + ". " + report.message;
  store_.owe_end(report);
  return false;
}

}  // namespace calibrd
