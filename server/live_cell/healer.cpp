// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/healer.hpp"

#include <algorithm>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

constexpr auto kBusyRetry = 500ms;  // another calibration of the sensor is under way
constexpr auto kLongWait = 1h;
constexpr auto kCandidateLook = 1s;  // whether it still holds
constexpr int kMovesWithoutPause = 4;
/// One posture may tell too little; two seldom do, and all that a calibration asks for take long to come.
constexpr int kQuickAttempts = 2;
constexpr int kEagerAttempts = kQuickAttempts + 1;  // these and the full one follow each other at once

}  // namespace

const char* name_of(HealingMode mode) {
  switch (mode) {
    case HealingMode::automatic:
      return "automatic";
    case HealingMode::ask:
      return "ask";
    case HealingMode::off:
      break;
  }
  return "off";
}

Healer::Healer(const HealerSettings& settings, Start start, Cancel cancel, LastMove last_move)
    : settings_(settings),
      start_(std::move(start)),
      cancel_(std::move(cancel)),
      last_move_(std::move(last_move)),
      thread_([this] { run(); }) {}

Healer::~Healer() {
  request_stop();
  thread_.join();
}

void Healer::request_stop() {
  const std::lock_guard lock(mutex_);
  is_stopping_ = true;
  changed_.notify_all();
}

void Healer::on_pose(const api::PoseReport& pose) {
  if (settings_.mode == HealingMode::off) return;
  const std::lock_guard lock(mutex_);
  Patient& patient = patients_[pose.sensor_id];
  const bool drifted = pose.state == api::PoseState::drifted;
  const auto calibration = pose.known ? pose.known->calibration_id : std::string();
  // One that was found meanwhile, and has drifted before anybody heard that it was good, is another move.
  const bool is_another = drifted && calibration != patient.drifted_calibration;
  if (drifted == patient.drifted && !is_another) return;
  patient.drifted = drifted;
  if (drifted) patient.drifted_calibration = calibration;
  patient.candidate.clear();
  if (drifted) plan(patient, Clock::now());
  changed_.notify_all();
}

void Healer::plan(Patient& patient, Clock::time_point now) const {
  if (now - patient.last_move > settings_.calm_after) patient.moves = 0;
  patient.last_move = now;
  patient.candidate.clear();
  patient.attempts = 0;
  patient.wants_all = false;
  ++patient.moves;
  // A sensor that hangs loose would else be calibrated without end.
  patient.due = patient.moves <= kMovesWithoutPause ? now : now + pause_after(patient.moves);
}

void Healer::on_calibration(const api::CalibrationReport& calibration, Clock::time_point seen_at) {
  if (!calibration.finished) return;
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !is_starting_; });  // it may be the one that is just being started
  const auto found = patients_.find(calibration.sensor_id);
  if (found == patients_.end()) return;
  Patient& patient = found->second;
  if (!patient.under_way || patient.under_way->calibration_id != calibration.id) {  // somebody's own
    if (calibration.current) patient.wants_all = false;
    return;
  }
  const bool refined = patient.under_way->refines;
  patient.under_way.reset();
  changed_.notify_all();
  if (refined) return;  // however it has ended: there is a pose, or the sensor has moved and is next
  patient.wants_all = tells_too_little(patient, calibration);
  const bool is_needed = patient.drifted;  // not where somebody has put the pose right meanwhile
  if (calibration.status == api::JobStatus::succeeded && !calibration.activate && is_needed) {
    patient.candidate = calibration.id;
    patient.candidate_seen_at = seen_at;
  }
  const bool eager = patient.attempts < kEagerAttempts && calibration.status == api::JobStatus::failed;
  patient.due = Clock::now() + (eager ? Clock::duration(0) : pause_after(patient.attempts));
}

void Healer::on_choice(const std::string& sensor_id) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !is_starting_; });
  const auto found = patients_.find(sensor_id);
  if (found == patients_.end()) return;
  Patient& patient = found->second;
  patient.wants_all = false;
  patient.candidate.clear();
  patient.drifted = false;                       // until the sensor says that this one has, too
  if (patient.under_way) cancel(patient, lock);  // else it would replace what was chosen
}

bool Healer::decline(const std::string& calibration_id) {
  const std::lock_guard lock(mutex_);
  for (auto& [sensor_id, patient] : patients_) {
    if (patient.candidate.empty() || patient.candidate != calibration_id) continue;
    patient.candidate.clear();
    patient.due = Clock::now() + pause_after(patient.attempts);
    changed_.notify_all();
    return true;
  }
  return false;
}

bool Healer::tells_too_little(const Patient& patient, const api::CalibrationReport& calibration) const {
  const auto& result = calibration.result;
  const bool was_quick = patient.attempts >= 1 && patient.attempts <= kQuickAttempts;
  if (!was_quick || calibration.status != api::JobStatus::succeeded || !calibration.activate) return false;
  return result && (result->sigma_position_m > settings_.quick_sigma_m ||
                    result->sigma_rotation_rad > settings_.quick_sigma_rad);
}

Clock::duration Healer::pause_after(int attempts) const {
  auto pause = settings_.cooldown;
  for (int i = kEagerAttempts; i < attempts && pause < settings_.longest_cooldown; ++i) pause *= 2;
  return std::min(pause, settings_.longest_cooldown);
}

std::string Healer::candidate(const std::string& sensor_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = patients_.find(sensor_id);
  if (found == patients_.end() || !has_candidate(sensor_id, found->second)) return {};
  return found->second.candidate;
}

/// A candidate of where the sensor was before it moved once more is none.
bool Healer::has_candidate(const std::string& sensor_id, const Patient& patient) const {
  return !patient.candidate.empty() && patient.candidate_seen_at > last_move_(sensor_id);
}

std::optional<Clock::time_point> Healer::next_attempt(const std::string& sensor_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = patients_.find(sensor_id);
  if (found == patients_.end()) return std::nullopt;
  const Patient& patient = found->second;
  if (!patient.drifted || patient.under_way || has_candidate(sensor_id, patient)) return std::nullopt;
  return patient.due;
}

void Healer::run() {
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    auto wake = Clock::now() + kLongWait;
    std::string next;
    Patient* overtaken = nullptr;  // a pose that has drifted needs another one, not a better one some time
    for (auto& [id, patient] : patients_) {
      if (!patient.drifted && !patient.wants_all) continue;
      if (patient.under_way) {
        if (patient.drifted && patient.under_way->refines) overtaken = &patient;
        continue;
      }
      if (has_candidate(id, patient)) {
        wake = std::min(wake, Clock::now() + kCandidateLook);
        continue;
      }
      if (!patient.candidate.empty())
        plan(patient, Clock::now());  // it has moved while somebody thought it over
      if (patient.due <= Clock::now()) next = id;
      wake = std::min(wake, patient.due);
    }
    if (overtaken)
      cancel(*overtaken, lock);
    else if (next.empty())
      changed_.wait_until(lock, wake);
    else
      begin(next, lock);
  }
}

void Healer::cancel(Patient& patient, std::unique_lock<std::mutex>& lock) {
  const std::string calibration_id = patient.under_way->calibration_id;
  patient.under_way.reset();
  lock.unlock();
  cancel_(calibration_id);
  lock.lock();
}

api::CalibrationRequest Healer::next_request(const std::string& sensor_id) const {
  const Patient& patient = patients_.at(sensor_id);
  api::CalibrationRequest request;
  request.sensor_id = sensor_id;
  request.activate = settings_.mode == HealingMode::automatic;
  request.after_move = patient.drifted;
  if (patient.drifted && patient.attempts < kQuickAttempts) {
    request.postures = settings_.postures;
    request.patience = settings_.patience;
  }
  return request;
}

void Healer::begin(const std::string& sensor_id, std::unique_lock<std::mutex>& lock) {
  const auto request = next_request(sensor_id);
  is_starting_ = true;
  lock.unlock();
  const auto started = start_(request);
  lock.lock();
  is_starting_ = false;
  changed_.notify_all();
  Patient& patient = patients_[sensor_id];
  if (!started) {
    patient.due = Clock::now() + kBusyRetry;
    return;
  }
  patient.under_way = Attempt{started->id, !request.after_move};
  patient.wants_all = false;
  if (request.after_move) ++patient.attempts;
}

}  // namespace calibrd
