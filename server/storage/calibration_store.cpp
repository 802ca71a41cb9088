// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/calibration_store.hpp"

#include <utility>

#include "api/json/calibration_result_json.hpp"
#include "api/routes/names.hpp"
#include "server/storage/background_text.hpp"
#include "server/storage/evidence_rows.hpp"
#include "server/storage/guarded.hpp"

namespace calibrd {
namespace {

using api::CalibrationReport;
using api::JobStatus;
using std::chrono::milliseconds;

std::int64_t ms_of(api::SystemTime time) {
  return std::chrono::duration_cast<milliseconds>(time.time_since_epoch()).count();
}

}  // namespace

/// Lets `statements` write as a whole, or not at all; the caller holds mutex_.
Status CalibrationStore::write_now(const std::function<Status()>& statements) {
  if (unusable_) return *unusable_;
  auto status = [&]() -> Status {
    Transaction transaction(*database_);
    if (auto written = statements(); !written) return written;
    return transaction.commit();
  }();
  note(status);
  return status;
}

/// `sensor_id`: whose current calibration it may change. The caller holds mutex_.
Status CalibrationStore::write(const std::string& sensor_id, const std::function<Status()>& statements) {
  auto status = write_now(statements);
  if (status && !sensor_id.empty()) save_current(sensor_id);
  return status;
}

Status CalibrationStore::add(const CalibrationReport& calibration, const api::CalibrationRequest& request) {
  return guarded([&] { return write_now([&] { return insert_start(calibration, request); }); });
}

Status CalibrationStore::insert_start(const CalibrationReport& calibration,
                                      const api::CalibrationRequest& request) {
  Statement insert(
      *database_,
      "INSERT INTO calibrations (id, sensor_id, created_ms, method, postures, activate, fingerprint, "
      "idempotency_key) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(calibration.id).bind(calibration.sensor_id).bind(ms_of(calibration.created));
  insert.bind(std::string(api::name_of(calibration.method))).bind(calibration.postures_wanted);
  insert.bind(calibration.activate ? 1 : 0).bind(request.fingerprint);
  request.idempotency_key.empty() ? insert.bind_null() : insert.bind(request.idempotency_key);
  insert.next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::finish(const CalibrationReport& calibration,
                                const std::optional<std::string>& activated_with) {
  return guarded([&] {
    if (!activated_with) return write_now([&] { return insert_end(calibration); });
    return write(calibration.sensor_id, [&] {
      auto inserted = insert_end(calibration);
      return inserted ? insert_activation(calibration, *activated_with) : inserted;
    });
  });
}

Status CalibrationStore::insert_end(const CalibrationReport& calibration) {
  Statement insert(
      *database_,
      "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
      "VALUES (?, ?, ?, ?, ?, ?)");
  insert.bind(calibration.id).bind(ms_of(calibration.finished.value_or(std::chrono::system_clock::now())));
  insert.bind(std::string(api::name_of(calibration.status))).bind(calibration.message);
  insert.bind(calibration.postures_seen);
  calibration.result ? insert.bind(api::calibration_result_json(*calibration.result)) : insert.bind_null();
  insert.next();
  auto inserted = insert.status(StorageError::cannot_write);
  if (!inserted || !calibration.evidence) return inserted;
  return insert_evidence(*database_, calibration.id, *calibration.evidence);
}

void CalibrationStore::owe_end(const CalibrationReport& calibration) {
  const std::lock_guard lock(mutex_);
  owed_ends_.insert_or_assign(calibration.id, calibration);
}

Status CalibrationStore::activate(const CalibrationReport& calibration, const std::string& basis) {
  return guarded(
      [&] { return write(calibration.sensor_id, [&] { return insert_activation(calibration, basis); }); });
}

Status CalibrationStore::insert_activation(const CalibrationReport& calibration, const std::string& basis) {
  Statement insert(
      *database_,
      "INSERT INTO activations (sensor_id, calibration_id, activated_ms, basis) VALUES (?, ?, ?, ?)");
  insert.bind(calibration.sensor_id).bind(calibration.id).bind(ms_of(std::chrono::system_clock::now()));
  insert.bind(basis).next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::add_drift(const std::string& calibration_id) {
  return guarded([&] {
    owed_drifts_.insert(calibration_id);
    auto status = write_now([&] { return insert_drift(calibration_id); });
    if (status) owed_drifts_.erase(calibration_id);
    if (status) save_current_of(calibration_id);
    return status;
  });
}

Status CalibrationStore::insert_drift(const std::string& calibration_id) {
  Statement insert(
      *database_,
      "INSERT OR IGNORE INTO drifts (activation, found_ms) SELECT a.number, ? FROM activations a "
      "WHERE a.calibration_id = ? AND a.number = "
      "(SELECT MAX(b.number) FROM activations b WHERE b.sensor_id = a.sensor_id)");
  insert.bind(ms_of(std::chrono::system_clock::now())).bind(calibration_id).next();
  return insert.status(StorageError::cannot_write);
}

/// Of the same sensor: all but the newest, and that of the current pose.
Status CalibrationStore::drop_old_backgrounds(const std::string& calibration_id) {
  constexpr int kKept = 200;  // kOldBackgroundsMayGo guards as many
  Statement remove(*database_,
                   "DELETE FROM backgrounds WHERE calibration_id IN (SELECT c.id FROM calibrations c "
                   "JOIN backgrounds b ON b.calibration_id = c.id "
                   "WHERE c.sensor_id = (SELECT sensor_id FROM calibrations WHERE id = ?) "
                   "ORDER BY c.number DESC LIMIT -1 OFFSET ?) AND calibration_id NOT IN "
                   "(SELECT calibration_id FROM activations "
                   "WHERE number IN (SELECT MAX(number) FROM activations GROUP BY sensor_id))");
  remove.bind(calibration_id).bind(kKept).next();
  return remove.status(StorageError::cannot_write);
}

Status CalibrationStore::add_background(const std::string& calibration_id,
                                        const std::vector<float>& depth_m) {
  return guarded([&] {
    auto status = write_now([&] {
      Statement insert(*database_,
                       "INSERT OR IGNORE INTO backgrounds (calibration_id, depths) VALUES (?, ?)");
      insert.bind(calibration_id).bind(background_text(depth_m)).next();
      if (auto inserted = insert.status(StorageError::cannot_write); !inserted) return inserted;
      return drop_old_backgrounds(calibration_id);
    });
    if (status) save_current_of(calibration_id);
    return status;
  });
}

}  // namespace calibrd
