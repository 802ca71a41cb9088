// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "api/service/reports.hpp"
#include "server/live_cell/live_sensor.hpp"
#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// core's calibrate(), for one robot.
using CalibrateFunction =
    std::function<CalibrationResult(const CameraModel&, std::span<const View>, const CalibrationSettings&)>;

struct JobSettings {
  CollectorSettings collector;  ///< its postures: where the request names no number
  Clock::duration collect_timeout = std::chrono::minutes(10);
};

/// Against the pose that another sensor serves, from what both see of the cell.
struct Objection {
  LiveSensor* sensor;
  std::string calibration_id;  ///< of that pose: another one is not meant
  std::string reason;
};

/// What the views of an accepted calibration show besides the robot.
struct Surroundings {
  std::shared_ptr<const BackgroundMap> background;  ///< null where nobody watches for drift
  std::vector<Objection> objections;                ///< which count once the pose is served
  bool has_moved = false;  ///< the newest frame does not show it where they did: the sensor may have moved
};

/// What is kept of a calibration beside its result.
struct EvidenceKeeper {
  /// What it is made from and with; without views before there are any.
  std::function<api::Evidence(std::span<const View>)> describe;
  /// Keeps the views themselves; called once the end is stored and published.
  std::function<void(const api::CalibrationReport&, LiveSensor&, std::span<const View>)> keep_views;
};

/// Runs calibrations: collects postures of any number of sensors at a time, computes one at a time on a
/// thread of its own, stores every outcome, and makes an accepted one the current pose. Safe to call from any
/// thread. Errors: api::ApiError.
class CalibrationJobs {
 public:
  /// Called for a calibration that has succeeded and is stored; `current`: its pose is the one to serve now.
  /// `seen_at`: when its last view was taken.
  using Publish =
      std::function<void(const api::CalibrationReport&, Clock::time_point seen_at, const Surroundings&)>;
  /// Looks at an accepted result, on the jobs' thread, before it is stored or published; may make it
  /// uncertain.
  using Review =
      std::function<Surroundings(LiveSensor& sensor, std::span<const View> views, CalibrationResult&)>;
  /// `seen_at`: when the last view was taken that it was computed from, if it was.
  using Log = std::function<void(const api::CalibrationReport&, Clock::time_point seen_at)>;

  /// `store` must outlive it. `log` hears of every calibration that has ended, and of one that is still
  /// collecting when it has lost postures.
  CalibrationJobs(CalibrationStore& store, CalibrateFunction calibrate, Publish publish, Log log,
                  JobSettings settings, Review review = {}, EvidenceKeeper evidence = {});
  ~CalibrationJobs();

  /// `sensor` must outlive the jobs. `guess`: where the request leaves the start to the cell. Without any, at
  /// least two postures are collected, and a request for one, or for the paper's method, is refused.
  Result<api::CalibrationReport> start(const api::CalibrationRequest& request, LiveSensor& sensor,
                                       const std::optional<Pose>& guess);
  Result<api::CalibrationReport> find(const std::string& id) const;
  Result<api::CalibrationReport> cancel(const std::string& id);
  /// Id of the sensor's calibration under way; empty: none.
  std::string active(const std::string& sensor_id) const;
  /// Id of the sensor's calibration that has ended last, of those of this run; empty: none.
  std::string ended(const std::string& sensor_id) const;

  /// Cancels everything under way and ends the thread; a computation under way ends at its next look at the
  /// flag.
  void request_stop();
  /// Waits for the thread to end; nobody is told of anything after it.
  void join();

 private:
  struct Job;
  using JobPointer = std::shared_ptr<Job>;

  Result<std::optional<api::CalibrationReport>> started_before(const api::CalibrationRequest& request) const;
  JobPointer make_job(const api::CalibrationRequest& request, LiveSensor& sensor,
                      const std::optional<Pose>& guess);
  void run();
  JobPointer next_ready();
  void end_patience(Clock::time_point now);
  std::vector<JobPointer> take_overdue(Clock::time_point now);
  static void begin_computing(Job& job);
  void compute_safely(const JobPointer& job);
  void compute(const JobPointer& job);
  CalibrationResult calibrate(const JobPointer& job, std::span<const View> views);
  void end(const JobPointer& job, api::JobStatus status, std::string message,
           std::optional<CalibrationResult> result = {});
  void end_overdue(const JobPointer& job);
  void end_computed(const JobPointer& job, CalibrationResult result);
  bool store_end(api::CalibrationReport& report, const std::string& basis);
  api::CalibrationReport report_of(const Job& job) const;
  void tell_of_drop(const std::string& id) const;

  CalibrationStore& store_;
  const CalibrateFunction calibrate_;
  const Publish publish_;
  const Log log_;
  const JobSettings settings_;
  const Review review_;
  const EvidenceKeeper evidence_;

  std::mutex starting_;  // one start() at a time: two requests with one key start one calibration
  std::mt19937 random_{std::random_device{}()};  // guarded by starting_

  mutable std::mutex mutex_;  // guards what follows, and every Job's report and phase
  std::condition_variable changed_;
  std::map<std::string, JobPointer> jobs_;    // those under way
  std::map<std::string, std::string> ended_;  // calibration by sensor
  bool is_stopping_ = false;

  std::thread thread_;
};

}  // namespace calibrd
