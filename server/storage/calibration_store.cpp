// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/calibration_store.hpp"

#include <array>
#include <new>
#include <utility>

#include "api/json/calibration_result_json.hpp"
#include "api/routes/names.hpp"
#include "server/storage/background_text.hpp"
#include "server/storage/schema.hpp"

namespace calibrd {
namespace {

using api::CalibrationReport;
using api::JobStatus;
using std::chrono::milliseconds;

constexpr const char* kInterrupted = "The daemon ended before this calibration did; start it again.";

std::int64_t ms_of(api::SystemTime time) {
  return std::chrono::duration_cast<milliseconds>(time.time_since_epoch()).count();
}

}  // namespace

Result<std::unique_ptr<CalibrationStore>> CalibrationStore::open(const std::filesystem::path& file,
                                                                 const std::string& vfs) {
  std::error_code failure;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
  if (failure) return Error{StorageError::cannot_open, file.string() + " (" + failure.message() + ")"};
  auto lock = StoreLock::take(file);
  if (!lock) return lock.error();
  auto database = Database::open(file, vfs);
  if (!database) return database.error();
  std::unique_ptr<CalibrationStore> store(new CalibrationStore(*std::move(lock), *std::move(database)));
  for (auto step : {&CalibrationStore::prepare_schema, &CalibrationStore::end_interrupted})
    if (auto status = ((*store).*step)(); !status)
      return Error{status.error().code, file.string() + " (" + status.error().detail + ")"};
  return store;
}

Status CalibrationStore::prepare_schema() {
  std::int64_t version = 0;
  {
    Statement query(database_, "PRAGMA user_version");
    if (query.next()) version = query.number(0);
    if (auto status = query.status(StorageError::not_a_store); !status) return status;
  }
  const auto newest = static_cast<std::int64_t>(kSchemaSteps.size());
  if (version == newest) return Done{};
  if (version > newest || version < 0)
    return Error{StorageError::newer_schema, "schema " + std::to_string(version)};
  std::string steps;
  for (auto step = version; step < newest; ++step) steps += kSchemaSteps[static_cast<std::size_t>(step)];
  return database_.run(
      "BEGIN IMMEDIATE;" + steps + "PRAGMA user_version = " + std::to_string(newest) + "; COMMIT;",
      StorageError::not_a_store);
}

Status CalibrationStore::end_interrupted() {
  Statement insert(
      database_,
      "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
      "SELECT id, ?, 'failed', ?, 0, NULL FROM calibrations "
      "WHERE id NOT IN (SELECT calibration_id FROM results)");
  insert.bind(ms_of(std::chrono::system_clock::now())).bind(std::string(kInterrupted)).next();
  return insert.status(StorageError::cannot_write);
}

/// Lets `statements` write as a whole, or not at all.
Status CalibrationStore::write(const std::function<Status()>& statements) {
  const std::lock_guard lock(mutex_);
  try {
    Transaction transaction(database_);
    if (auto written = statements(); !written) return written;
    return transaction.commit();
  } catch (const std::bad_alloc&) {
    return Error{StorageError::out_of_memory, {}};
  }
}

Status CalibrationStore::add(const CalibrationReport& calibration, const api::CalibrationRequest& request) {
  return write([&] {
    Statement insert(
        database_,
        "INSERT INTO calibrations (id, sensor_id, created_ms, method, postures, activate, fingerprint, "
        "idempotency_key) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    insert.bind(calibration.id).bind(calibration.sensor_id).bind(ms_of(calibration.created));
    insert.bind(std::string(api::name_of(calibration.method))).bind(calibration.postures_wanted);
    insert.bind(calibration.activate ? 1 : 0).bind(request.fingerprint);
    request.idempotency_key.empty() ? insert.bind_null() : insert.bind(request.idempotency_key);
    insert.next();
    return insert.status(StorageError::cannot_write);
  });
}

Status CalibrationStore::finish(const CalibrationReport& calibration,
                                const std::optional<std::string>& activated_with) {
  return write([&]() -> Status {
    Statement insert(
        database_,
        "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
        "VALUES (?, ?, ?, ?, ?, ?)");
    insert.bind(calibration.id).bind(ms_of(calibration.finished.value_or(std::chrono::system_clock::now())));
    insert.bind(std::string(api::name_of(calibration.status))).bind(calibration.message);
    insert.bind(calibration.postures_seen);
    calibration.result ? insert.bind(api::calibration_result_json(*calibration.result)) : insert.bind_null();
    insert.next();
    auto inserted = insert.status(StorageError::cannot_write);
    return inserted && activated_with ? insert_activation(calibration, *activated_with) : inserted;
  });
}

Status CalibrationStore::activate(const CalibrationReport& calibration, const std::string& basis) {
  return write([&] { return insert_activation(calibration, basis); });
}

Status CalibrationStore::insert_activation(const CalibrationReport& calibration, const std::string& basis) {
  Statement insert(
      database_,
      "INSERT INTO activations (sensor_id, calibration_id, activated_ms, basis) VALUES (?, ?, ?, ?)");
  insert.bind(calibration.sensor_id).bind(calibration.id).bind(ms_of(std::chrono::system_clock::now()));
  insert.bind(basis).next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::add_drift(const std::string& calibration_id) {
  return write([&] {
    Statement insert(
        database_,
        "INSERT OR IGNORE INTO drifts (activation, found_ms) SELECT a.number, ? FROM activations a "
        "WHERE a.calibration_id = ? AND a.number = "
        "(SELECT MAX(b.number) FROM activations b WHERE b.sensor_id = a.sensor_id)");
    insert.bind(ms_of(std::chrono::system_clock::now())).bind(calibration_id).next();
    return insert.status(StorageError::cannot_write);
  });
}

Status CalibrationStore::add_background(const std::string& calibration_id,
                                        const std::vector<float>& depth_m) {
  return write([&] {
    Statement insert(database_, "INSERT OR IGNORE INTO backgrounds (calibration_id, depths) VALUES (?, ?)");
    insert.bind(calibration_id).bind(background_text(depth_m)).next();
    return insert.status(StorageError::cannot_write);
  });
}

}  // namespace calibrd
