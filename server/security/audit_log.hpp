// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "api/access/audit_record.hpp"

namespace calibrd {

struct AuditSettings {
  std::filesystem::path file;            ///< older ones beside it: audit.1.jsonl is the newest of them
  std::uint64_t max_bytes = 10'000'000;  ///< of one file
  int files = 10;                        ///< kept in all
};

/// Who changed what, when, and what became of it: one JSON object per line, on the disk when write() returns.
/// Safe to call from any thread.
class AuditLog {
 public:
  /// `on_failure` is told, with the line itself, what could not be written.
  AuditLog(AuditSettings settings, std::function<void(const std::string&)> on_failure);
  ~AuditLog();

  void write(const api::AuditRecord& record);

 private:
  bool append(const std::string& line);
  bool open();
  bool rotate();
  std::filesystem::path older(int number) const;

  const AuditSettings settings_;
  const std::function<void(const std::string&)> on_failure_;
  std::mutex mutex_;
  int descriptor_ = -1;      // guarded by mutex_, as what follows
  std::uint64_t bytes_ = 0;  // of the file
};

/// {"time": …, "who": …, "from": …, "request": …, "what": "POST /api/v1/…", "status": 202, "result": "done" |
/// "refused" | "failed"} and, where something was made, "made".
std::string audit_line(const api::AuditRecord& record);

}  // namespace calibrd
