// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/calibration_store.hpp"

#include <array>
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

constexpr const char* kSelect =
    "SELECT c.id, c.sensor_id, c.created_ms, c.method, c.postures, c.activate, r.finished_ms, r.status, "
    "r.message, "
    "r.postures_seen, r.result, "
    "c.id = (SELECT a.calibration_id FROM activations a WHERE a.sensor_id = c.sensor_id ORDER BY a.number "
    "DESC LIMIT 1) "
    "FROM calibrations c LEFT JOIN results r ON r.calibration_id = c.id ";

constexpr const char* kInterrupted = "The daemon ended before this calibration did; start it again.";

std::int64_t ms_of(api::SystemTime time) {
  return std::chrono::duration_cast<milliseconds>(time.time_since_epoch()).count();
}

api::SystemTime time_of(std::int64_t ms) { return api::SystemTime(milliseconds(ms)); }

JobStatus ended_status(const std::string& name) {
  for (const auto status : {JobStatus::succeeded, JobStatus::failed, JobStatus::cancelled})
    if (name == api::name_of(status)) return status;
  return JobStatus::queued;
}

/// The calibration of a row of kSelect.
Result<CalibrationReport> read_row(const Statement& row) {
  CalibrationReport report;
  report.id = row.text(0);
  report.sensor_id = row.text(1);
  report.created = time_of(row.number(2));
  report.method = row.text(3) == "paper" ? Method::paper : Method::full;
  report.postures_wanted = static_cast<int>(row.number(4));
  report.activate = row.number(5) != 0;
  if (const auto finished_ms = row.optional_number(6)) {
    report.finished = time_of(*finished_ms);
    report.status = ended_status(row.text(7));
    report.message = row.text(8);
    report.postures_seen = static_cast<int>(row.number(9));
    report.progress = 1;
  }
  if (const auto stored = row.optional_text(10)) {
    auto result = api::parse_calibration_result(*stored);
    if (!result) return Error{StorageError::not_a_store, "result of " + report.id};
    report.result = *std::move(result);
  }
  report.current = row.optional_number(11).value_or(0) != 0;
  return report;
}

}  // namespace

Result<std::unique_ptr<CalibrationStore>> CalibrationStore::open(const std::filesystem::path& file) {
  std::error_code failure;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
  if (failure) return Error{StorageError::cannot_open, file.string() + " (" + failure.message() + ")"};
  auto lock = StoreLock::take(file);
  if (!lock) return lock.error();
  auto database = Database::open(file);
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

Status CalibrationStore::add(const CalibrationReport& calibration, const api::CalibrationRequest& request) {
  const std::lock_guard lock(mutex_);
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
}

Status CalibrationStore::finish(const CalibrationReport& calibration) {
  const std::lock_guard lock(mutex_);
  Statement insert(
      database_,
      "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
      "VALUES (?, ?, ?, ?, ?, ?)");
  insert.bind(calibration.id).bind(ms_of(calibration.finished.value_or(std::chrono::system_clock::now())));
  insert.bind(std::string(api::name_of(calibration.status))).bind(calibration.message);
  insert.bind(calibration.postures_seen);
  calibration.result ? insert.bind(api::calibration_result_json(*calibration.result)) : insert.bind_null();
  insert.next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::activate(const CalibrationReport& calibration, const std::string& basis) {
  const std::lock_guard lock(mutex_);
  Statement insert(
      database_,
      "INSERT INTO activations (sensor_id, calibration_id, activated_ms, basis) VALUES (?, ?, ?, ?)");
  insert.bind(calibration.sensor_id).bind(calibration.id).bind(ms_of(std::chrono::system_clock::now()));
  insert.bind(basis).next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::add_drift(const std::string& calibration_id) {
  const std::lock_guard lock(mutex_);
  Statement insert(
      database_,
      "INSERT OR IGNORE INTO drifts (activation, found_ms) SELECT a.number, ? FROM activations a "
      "WHERE a.calibration_id = ? AND a.number = "
      "(SELECT MAX(b.number) FROM activations b WHERE b.sensor_id = a.sensor_id)");
  insert.bind(ms_of(std::chrono::system_clock::now())).bind(calibration_id).next();
  return insert.status(StorageError::cannot_write);
}

Status CalibrationStore::add_background(const std::string& calibration_id,
                                        const std::vector<float>& depth_m) {
  const std::lock_guard lock(mutex_);
  Statement insert(database_, "INSERT OR IGNORE INTO backgrounds (calibration_id, depths) VALUES (?, ?)");
  insert.bind(calibration_id).bind(background_text(depth_m)).next();
  return insert.status(StorageError::cannot_write);
}

Result<std::optional<std::vector<float>>> CalibrationStore::background(const std::string& calibration_id) {
  const std::lock_guard lock(mutex_);
  Statement query(database_, "SELECT depths FROM backgrounds WHERE calibration_id = ?");
  query.bind(calibration_id);
  std::optional<std::vector<float>> found;
  if (query.next()) found = parse_background(query.text(0));
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return found;
}

Result<std::optional<CalibrationReport>> CalibrationStore::find_where(const std::string& condition,
                                                                      const std::string& value) {
  const std::lock_guard lock(mutex_);
  Statement query(database_, kSelect + condition);
  query.bind(value);
  std::optional<CalibrationReport> found;
  if (query.next()) {
    auto report = read_row(query);
    if (!report) return report.error();
    found = *std::move(report);
  }
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return found;
}

Result<std::optional<CalibrationReport>> CalibrationStore::find(const std::string& id) {
  return find_where("WHERE c.id = ?", id);
}

Result<std::optional<CurrentCalibration>> CalibrationStore::current(const std::string& sensor_id) {
  CurrentCalibration current;
  {
    const std::lock_guard lock(mutex_);
    Statement query(
        database_,
        "SELECT calibration_id, basis, number IN (SELECT activation FROM drifts) FROM activations "
        "WHERE sensor_id = ? ORDER BY number DESC LIMIT 1");
    query.bind(sensor_id);
    if (query.next()) {
      current.calibration.id = query.text(0);
      current.basis = query.text(1);
      current.drifted = query.number(2) != 0;
    }
    if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  }
  if (current.calibration.id.empty()) return std::optional<CurrentCalibration>();
  auto report = find(current.calibration.id);
  if (!report) return report.error();
  if (!*report) return std::optional<CurrentCalibration>();
  current.calibration = **std::move(report);
  return std::optional(std::move(current));
}

Result<api::HistoryPage> CalibrationStore::history(const api::HistoryQuery& query) {
  const std::lock_guard lock(mutex_);
  std::string sql = std::string(kSelect) + "WHERE c.sensor_id = ? ";
  if (!query.before.empty()) sql += "AND c.number < (SELECT number FROM calibrations WHERE id = ?) ";
  Statement rows(database_, sql + "ORDER BY c.number DESC LIMIT ?");
  rows.bind(query.sensor_id);
  if (!query.before.empty()) rows.bind(query.before);
  rows.bind(query.limit + 1);
  api::HistoryPage page;
  while (rows.next()) {
    if (static_cast<int>(page.calibrations.size()) == query.limit) {
      page.more = true;
      break;
    }
    auto report = read_row(rows);
    if (!report) return report.error();
    page.calibrations.push_back(*std::move(report));
  }
  if (auto status = rows.status(StorageError::cannot_read); !status) return status.error();
  return page;
}

Result<std::optional<KeyedStart>> CalibrationStore::find_start(const std::string& sensor_id,
                                                               const std::string& idempotency_key) {
  const std::lock_guard lock(mutex_);
  Statement query(database_,
                  "SELECT id, fingerprint FROM calibrations WHERE sensor_id = ? AND idempotency_key = ?");
  query.bind(sensor_id).bind(idempotency_key);
  std::optional<KeyedStart> found;
  if (query.next()) found = KeyedStart{query.text(0), query.text(1)};
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return found;
}

}  // namespace calibrd
