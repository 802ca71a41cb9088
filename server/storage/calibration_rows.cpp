// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of CalibrationStore that reads.
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

constexpr const char* kSelect =
    "SELECT c.id, c.sensor_id, c.created_ms, c.method, c.postures, c.activate, r.finished_ms, r.status, "
    "r.message, r.postures_seen, r.result, c.id = (SELECT a.calibration_id FROM activations a WHERE "
    "a.sensor_id = c.sensor_id ORDER BY a.number DESC LIMIT 1) FROM calibrations c LEFT JOIN results r ON "
    "r.calibration_id = c.id ";

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
    if (!result)
      return Error{StorageError::cannot_read,
                   "result of " + report.id + " (" + result.error().message() + ")"};
    report.result = *std::move(result);
  }
  report.current = row.optional_number(11).value_or(0) != 0;
  return report;
}

}  // namespace

Result<std::optional<std::vector<float>>> CalibrationStore::background(const std::string& calibration_id) {
  return guarded([&]() -> Result<std::optional<std::vector<float>>> {
    Statement query(*database_, "SELECT depths FROM backgrounds WHERE calibration_id = ?");
    query.bind(calibration_id);
    std::optional<std::vector<float>> found;
    if (query.next()) found = parse_background(query.text(0));
    if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
    return found;
  });
}

/// The caller holds mutex_.
Result<std::optional<CalibrationReport>> CalibrationStore::find_row(const std::string& id) {
  Statement query(*database_, std::string(kSelect) + "WHERE c.id = ?");
  query.bind(id);
  std::optional<CalibrationReport> found;
  if (query.next()) {
    auto report = read_row(query);
    if (!report) return report.error();
    found = *std::move(report);
  }
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  if (const auto owed = owed_ends_.find(id); owed != owed_ends_.end()) found = owed->second;
  return found;
}

Result<std::optional<CalibrationReport>> CalibrationStore::find(const std::string& id) {
  return guarded([&] {
    auto found = find_row(id);
    if (!found || !*found || (*found)->evidence) return found;
    auto evidence = select_evidence(*database_, id);
    if (!evidence) return Result<std::optional<CalibrationReport>>(evidence.error());
    (*found)->evidence = *std::move(evidence);
    return found;
  });
}

Result<std::optional<CurrentCalibration>> CalibrationStore::current(const std::string& sensor_id) {
  return guarded([&]() -> Result<std::optional<CurrentCalibration>> {
    Statement query(
        *database_,
        "SELECT calibration_id, basis, number IN (SELECT activation FROM drifts) FROM activations "
        "WHERE sensor_id = ? ORDER BY number DESC LIMIT 1");
    query.bind(sensor_id);
    if (!query.next()) {
      if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
      return std::optional<CurrentCalibration>();
    }
    auto report = find_row(query.text(0));
    if (!report) return report.error();
    if (!*report) return std::optional<CurrentCalibration>();
    CurrentCalibration current{**std::move(report), query.text(1), query.number(2) != 0};
    if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
    current.drifted = current.drifted || owed_drifts_.contains(current.calibration.id);
    return std::optional(std::move(current));
  });
}

Result<api::HistoryPage> CalibrationStore::history(const api::HistoryQuery& query) {
  return guarded([&]() -> Result<api::HistoryPage> {
    std::string sql = std::string(kSelect) + "WHERE c.sensor_id = ? ";
    if (!query.before.empty()) sql += "AND c.number < (SELECT number FROM calibrations WHERE id = ?) ";
    Statement rows(*database_, sql + "ORDER BY c.number DESC LIMIT ?");
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
      const auto owed = owed_ends_.find(report->id);
      page.calibrations.push_back(owed == owed_ends_.end() ? *std::move(report) : owed->second);
    }
    if (auto status = rows.status(StorageError::cannot_read); !status) return status.error();
    return page;
  });
}

Result<std::optional<KeyedStart>> CalibrationStore::find_start(const std::string& sensor_id,
                                                               const std::string& idempotency_key) {
  return guarded([&]() -> Result<std::optional<KeyedStart>> {
    Statement query(*database_,
                    "SELECT id, fingerprint FROM calibrations WHERE sensor_id = ? AND idempotency_key = ?");
    query.bind(sensor_id).bind(idempotency_key);
    std::optional<KeyedStart> found;
    if (query.next()) found = KeyedStart{query.text(0), query.text(1)};
    if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
    return found;
  });
}

}  // namespace calibrd
