// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of CalibrationStore that keeps what a collector has not acknowledged.
#include <utility>

#include "server/storage/evidence_rows.hpp"
#include "server/storage/guarded.hpp"

namespace calibrd {
namespace {

struct Entry {
  std::int64_t number;
  std::string calibration_id;
};

Result<std::vector<Entry>> select_entries(Database& database, std::int64_t after, int limit) {
  Statement query(database,
                  "SELECT number, calibration_id FROM outbox WHERE number > ? ORDER BY number LIMIT ?");
  query.bind(after).bind(limit);
  std::vector<Entry> entries;
  while (query.next()) entries.push_back({query.number(0), query.text(1)});
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return entries;
}

}  // namespace

Result<std::vector<OutboxEntry>> CalibrationStore::outbox(std::int64_t after, int limit) {
  return guarded([&]() -> Result<std::vector<OutboxEntry>> {
    const auto entries = select_entries(*database_, after, limit);
    if (!entries) return entries.error();
    std::vector<OutboxEntry> found;
    for (const auto& entry : *entries) {
      auto report = find_row(entry.calibration_id);
      if (!report) return report.error();
      if (!*report) continue;
      auto evidence = select_evidence(*database_, entry.calibration_id);
      if (!evidence) return evidence.error();
      (*report)->evidence = *std::move(evidence);
      found.push_back({entry.number, **std::move(report)});
    }
    return found;
  });
}

Result<std::int64_t> CalibrationStore::outbox_size() {
  return guarded([&]() -> Result<std::int64_t> {
    Statement query(*database_, "SELECT COUNT(*) FROM outbox");
    query.next();
    const auto count = query.number(0);
    if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
    return count;
  });
}

Status CalibrationStore::remove_from_outbox(const std::vector<std::string>& calibration_ids) {
  return guarded([&] {
    return write_now([&]() -> Status {
      for (const auto& id : calibration_ids) {
        Statement remove(*database_, "DELETE FROM outbox WHERE calibration_id = ?");
        remove.bind(id).next();
        if (auto removed = remove.status(StorageError::cannot_write); !removed) return removed;
      }
      return Done{};
    });
  });
}

}  // namespace calibrd
