// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/live_cell.hpp"

#include <fstream>
#include <iterator>

#include "api/problem/api_error.hpp"
#include "server/live_cell/pose_basis.hpp"

namespace calibrd {

using api::ApiError;
namespace {

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

LiveCell::LiveCell(LiveCellSettings settings, const RobotModel& model, const VirtualCell& virtual_cell,
                   JointMapping mapping, CalibrationStore& store, Estimator estimator, CellLog log)
    : settings_(std::move(settings)),
      store_(store),
      estimator_(std::move(estimator)),
      log_(std::move(log)),
      robot_basis_(robot_basis(settings_.urdf, model, mapping)),
      robot_urdf_(file_text(settings_.urdf)),
      robot_(model, std::move(mapping), settings_.gate, settings_.joint_latency, settings_.controller_frame),
      motions_(settings_.motion, robot_, log_.on_motion),
      virtual_cell_(virtual_cell),
      clouds_(virtual_cell, robot_),
      frames_(virtual_cell),
      cloud_merger_(virtual_cell),
      obstacle_watch_(virtual_cell),
      jobs_(
          store, estimator_.calibrate,
          [this](const auto& calibration, auto seen_at, const auto& surroundings) {
            adopt(calibration, seen_at, surroundings);
          },
          [this](const auto& calibration, auto seen_at) {
            if (log_.on_calibration) log_.on_calibration(calibration);
            healer_.on_calibration(calibration, seen_at);
          },
          settings_.jobs,
          [this](auto& sensor, auto views, auto& result) { return review(sensor, views, result); },
          evidence_keeper()),
      healer_(
          settings_.healing, [this](const auto& request) { return start_calibration(request); },
          [this](const auto& calibration_id) { (void)jobs_.cancel(calibration_id); },
          [this](const auto& sensor_id) { return entries_.at(sensor_id)->sensor->moved_at(); }) {}

LiveCell::~LiveCell() {
  request_stop();
  // Sensors tell jobs of complete postures, and jobs refer to sensors: the threads of the former end first.
  for (const auto& [id, entry] : entries_) entry->sensor->join();
  jobs_.join();  // it tells the healer, which ends first
}

Status LiveCell::add_sensor(const SensorSetup& setup) {
  auto gate = settings_.gate;
  gate.latency = setup.latency;
  auto entry = std::make_unique<Entry>();
  entry->setup = setup;
  const auto basis = robot_basis_ + camera_basis(setup.camera, setup.mirror);
  entry->sensor = std::make_unique<LiveSensor>(
      LiveSensorSettings{setup.id, basis, setup.camera, gate, settings_.watch, setup.workspace}, robot_,
      estimator_.make_check(setup.camera), [this](const auto& pose) { hear_of_pose(pose); },
      make_monitor(setup),
      setup.estimates_time_offset && estimator_.make_time_offset ? estimator_.make_time_offset(setup.camera)
                                                                 : nullptr);
  entries_[setup.id] = std::move(entry);
  const auto stored = store_.current(setup.id);
  if (stored && *stored) restore(**stored, *entries_.at(setup.id)->sensor);
  if (!stored && log_.on_error)
    log_.on_error("sensor " + setup.id + " starts without its pose: " + stored.error().message());
  return Done{};
}

/// A stored pose holds for what it was found with: with other intrinsics or another robot the same numbers
/// may pass every check and still be wrong.
void LiveCell::restore(const CurrentCalibration& stored, const LiveSensor& sensor) {
  PoseOrigin origin;
  origin.drifted = stored.drifted;
  if (const auto changes = basis_changes(stored.basis, sensor.basis()); !changes.empty())
    origin.objection = "the configuration has changed since the pose was found: " + changes +
                       "; calibrate again, or activate the calibration to use its pose all the same";
  publish(stored.calibration, origin, stored_background(stored.calibration));
}

void LiveCell::hear_of_pose(const api::PoseReport& pose) {
  if (pose.state == api::PoseState::drifted && pose.known)
    store_drift(pose.sensor_id, pose.known->calibration_id);
  if (log_.on_pose) log_.on_pose(pose);
  healer_.on_pose(pose);
}

/// Where this cannot be stored, the pose is drifted all the same, and the store tries again until a restart.
void LiveCell::store_drift(const std::string& sensor_id, const std::string& calibration_id) {
  const auto stored = store_.add_drift(calibration_id);
  if (stored || !log_.on_error) return;
  log_.on_error("sensor " + sensor_id + ": that the pose of calibration " + calibration_id +
                " has drifted could not be stored yet, and would not be known after a restart: " +
                stored.error().message());
}

std::unique_ptr<DriftMonitor> LiveCell::make_monitor(const SensorSetup& setup) {
  if (!estimator_.make_watch) return nullptr;
  return std::make_unique<DriftMonitor>(estimator_.make_watch(setup.camera, setup.rate_hz));
}

/// The background is stored so that a sensor that is moved while nobody watches is found out after a
/// restart, too; also that of a calibration that waits to be activated.
void LiveCell::adopt(const api::CalibrationReport& calibration, Clock::time_point seen_at,
                     const Surroundings& surroundings) {
  PoseOrigin origin;
  origin.seen_at = seen_at;
  origin.moved_since = surroundings.has_moved;
  if (calibration.current && publish(calibration, origin, surroundings.background))
    for (const Objection& objection : surroundings.objections) withhold(objection);
  if (!surroundings.background) return;
  const auto stored = store_.add_background(calibration.id, surroundings.background->depths_m());
  if (!stored && log_.on_error)
    log_.on_error("the background of calibration " + calibration.id +
                  " could not be stored: " + stored.error().message());
}

std::shared_ptr<const BackgroundMap> LiveCell::stored_background(const api::CalibrationReport& calibration) {
  const auto entry = entries_.find(calibration.sensor_id);
  const auto depth_m = store_.background(calibration.id);
  if (entry == entries_.end() || !depth_m || !*depth_m) return nullptr;
  auto background = std::make_shared<BackgroundMap>(entry->second->setup.camera);
  background->recall(**depth_m, calibration.result ? calibration.result->views : 1);
  return background;
}

void LiveCell::start(const std::string& sensor_id, std::unique_ptr<DepthSource> source) {
  entries_.at(sensor_id)->sensor->start(std::move(source));
}

void LiveCell::request_stop() {
  is_stopping_ = true;
  motions_.request_stop();
  for (const auto& [id, entry] : entries_) {
    entry->sensor->request_stop();
    const std::lock_guard lock(entry->recording);
    if (entry->recording_task) entry->recording_task->cancel();
  }
  healer_.request_stop();
  jobs_.request_stop();
}

/// False: another calibration was made current meanwhile and is, or will be, the one that is served.
bool LiveCell::publish(const api::CalibrationReport& calibration, const PoseOrigin& origin,
                       std::shared_ptr<const BackgroundMap> background) {
  const auto entry = entries_.find(calibration.sensor_id);
  if (entry == entries_.end() || !calibration.result || !calibration.result->T_base_sensor) return false;
  const std::lock_guard lock(publishing_);
  const auto current = store_.current(calibration.sensor_id);
  if (current && *current && (*current)->calibration.id != calibration.id) return false;
  entry->second->sensor->set_pose(
      {calibration.id, calibration.finished.value_or(calibration.created), *calibration.result}, origin,
      std::move(background));
  return true;
}

std::map<std::string, const Heartbeat*> LiveCell::heartbeats() const {
  std::map<std::string, const Heartbeat*> all;
  for (const auto& [id, entry] : entries_) all[id] = &entry->sensor->heartbeat();
  return all;
}

Result<LiveCell::Entry*> LiveCell::find(std::string_view sensor_id) const {
  const auto entry = entries_.find(sensor_id);
  if (entry == entries_.end()) return fail(ApiError::no_such_sensor, std::string(sensor_id));
  return entry->second.get();
}

/// The last pose is a better start than the configured guess: sensors are knocked by less than guesses are
/// wrong. One that is known to be wrong is none. Nothing: the calibration finds the start itself.
std::optional<Pose> LiveCell::guess_for(const Entry& entry, const api::CalibrationRequest& request) const {
  if (request.after_move) return entry.sensor->seen_pose();
  const auto pose = entry.sensor->plausible_pose();
  return pose ? pose : entry.setup.guess_T_base_sensor;
}

api::SensorReport LiveCell::report_of(const Entry& entry) const {
  auto report = entry.sensor->report();
  report.job = jobs_.active(report.id);
  report.ended_job = jobs_.ended(report.id);
  return report;
}

api::CellReport LiveCell::cell() const {
  return {settings_.version, Clock::now() - began_, robot(), sensors(), store_.report()};
}

std::vector<api::SensorReport> LiveCell::sensors() const {
  std::vector<api::SensorReport> all;
  for (const auto& [id, entry] : entries_) all.push_back(report_of(*entry));
  return all;
}

Result<api::SensorReport> LiveCell::sensor(std::string_view id) const {
  const auto entry = find(id);
  if (!entry) return entry.error();
  return report_of(**entry);
}

Result<api::PoseReport> LiveCell::pose(std::string_view sensor_id) const {
  const auto entry = find(sensor_id);
  if (!entry) return entry.error();
  auto report = (*entry)->sensor->pose();
  report.job = jobs_.active(report.sensor_id);
  report.candidate = healer_.candidate(report.sensor_id);
  return report;
}

Result<api::DriftReport> LiveCell::drift(std::string_view sensor_id) const {
  const auto entry = find(sensor_id);
  if (!entry) return entry.error();
  auto report = (*entry)->sensor->drift();
  report.healing = name_of(healer_.mode());
  report.candidate = healer_.candidate(report.sensor_id);
  if (const auto next = healer_.next_attempt(report.sensor_id))
    report.healing_in = std::max(Clock::duration(0), *next - Clock::now());
  return report;
}

Result<api::CalibrationReport> LiveCell::start_calibration(const api::CalibrationRequest& request) {
  const auto entry = find(request.sensor_id);
  if (!entry) return entry.error();
  auto started = jobs_.start(request, *(*entry)->sensor, guess_for(**entry, request));
  if (started && log_.on_start) log_.on_start(*started);
  return started;
}

Result<api::CalibrationReport> LiveCell::cancel_calibration(std::string_view id) {
  if (healer_.decline(std::string(id))) return calibration(id);
  return jobs_.cancel(std::string(id));
}

Result<api::CalibrationReport> LiveCell::activate_calibration(std::string_view id) {
  const auto found = jobs_.find(std::string(id));
  if (!found) return found;
  if (!found->finished) return fail(ApiError::calibration_not_finished, found->id);
  if (found->status != api::JobStatus::succeeded) return fail(ApiError::not_activatable, found->id);
  const auto entry = find(found->sensor_id);
  if (!entry) return entry.error();
  if (auto activated = store_.activate(*found, (*entry)->sensor->basis()); !activated)
    return fail(ApiError::storage_failed, activated.error().message());
  healer_.on_choice(found->sensor_id);
  publish(*found, {}, stored_background(*found));
  return jobs_.find(std::string(id));
}

Estimator core_estimator(const VirtualCell& cell, const DriftSettings& drift) {
  Estimator estimator;
  estimator.calibrate = [&cell](const CameraModel& camera, std::span<const View> views,
                                const CalibrationSettings& settings) {
    return calibrate(cell, camera, views, settings);
  };
  estimator.make_check = [&cell](const CameraModel& camera) -> CheckFunction {
    return [checker = std::make_shared<PoseChecker>(cell, camera)](
               const View& view, const Pose& T_base_sensor, const DepthCorrection& correction,
               const Matrix6d& covariance) {
      return checker->check(view, T_base_sensor, correction, covariance);
    };
  };
  estimator.make_time_offset = [&cell](const CameraModel& camera) {
    return std::make_unique<TimeOffsetEstimator>(cell, camera);
  };
  estimator.make_watch = [&cell, drift](const CameraModel& camera, double rate_hz) {
    auto settings = drift;
    settings.shift.rate_hz = rate_hz;
    return std::make_unique<DriftWatch>(cell, camera, settings);
  };
  return estimator;
}

}  // namespace calibrd
