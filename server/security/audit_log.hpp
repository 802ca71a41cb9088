// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "api/access/audit_record.hpp"

namespace calibrd {

struct AuditSettings {
  std::filesystem::path file;            ///< older ones beside it: audit.1.jsonl is the newest of them
  std::uint64_t max_bytes = 10'000'000;  ///< of one file
  int files = 10;                        ///< kept in all
};

/// A change that no request made.
struct OwnChange {
  std::string who;   ///< "calibrd", "SIGHUP", "tokens file"
  std::string what;  ///< "pose of kinect2", "configuration", "tokens"
  bool is_done = true;
  std::string made = {};    ///< path of what serves from now on; empty: nothing does
  std::string detail = {};  ///< names of keys or tokens, or why it was refused
};

/// Who changed what, when, and what became of it: one JSON object per line, on the disk when write() returns.
/// Safe to call from any thread.
class AuditLog {
 public:
  /// `on_failure` is told, with the line itself, what could not be written.
  AuditLog(AuditSettings settings, std::function<void(const std::string&)> on_failure);
  ~AuditLog();

  void write(const api::AuditRecord& record);
  /// Returns at once, as threads may call it that must not wait for the disk; written soon after, and before
  /// the log ends.
  void note(const OwnChange& change);

 private:
  void write_line(const std::string& line);
  void write_noted(const std::stop_token& stopped);
  bool append(const std::string& line);
  bool open();
  bool rotate();
  std::filesystem::path older(int number) const;

  const AuditSettings settings_;
  const std::function<void(const std::string&)> on_failure_;
  std::mutex mutex_;
  int descriptor_ = -1;      // guarded by mutex_, as what follows
  std::uint64_t bytes_ = 0;  // of the file
  std::mutex noting_;
  std::condition_variable_any is_noted_;
  std::deque<std::string> noted_;  // guarded by noting_
  std::jthread writer_;            // the last: it ends first
};

/// {"time": …, "who": …, "from": …, "request": …, "what": "POST /api/v1/…", "status": 202, "result": "done" |
/// "refused" | "failed"} and, where something was made, "made".
std::string audit_line(const api::AuditRecord& record);
/// {"time": …, "who": …, "what": …, "result": "done" | "refused"} and, where there is such, "made" and
/// "detail".
std::string audit_line(const OwnChange& change);

}  // namespace calibrd
