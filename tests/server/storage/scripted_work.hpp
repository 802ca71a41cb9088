// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// A day of a store: every kind of call it has, with restarts, and what was reported as done.
class ScriptedWork {
 public:
  ScriptedWork(std::filesystem::path file, std::string vfs) : file_(std::move(file)), vfs_(std::move(vfs)) {}

  /// All of it; goes on after failures, as the daemon does.
  void run();
  /// One more calibration, which becomes current; opens the store where it is closed. True: all was Done.
  bool add_current(const std::string& id);
  void close() { store_.reset(); }

  /// What does not hold of what was reported as done, in the store of that file, which is opened for it.
  std::vector<std::string> broken_promises(const std::filesystem::path& file) const;
  const std::vector<Error>& errors() const { return errors_; }

 private:
  bool reopen();
  bool note(const Status& status);
  bool calibrate(const std::string& id, bool activate);
  void activate(const std::string& id);
  void drift(const std::string& id);
  void add_background(const std::string& id);
  void read_all();

  const std::filesystem::path file_;
  const std::string vfs_;
  std::unique_ptr<CalibrationStore> store_;
  std::vector<Error> errors_;
  std::set<std::string> added_, finished_, drifted_, backgrounds_;
  std::string current_;                  // by the last report of success
  std::set<std::string> maybe_current_;  // asked for since, without success
};

/// "ok", or what PRAGMA integrity_check says.
std::string integrity_of(const std::filesystem::path& file);

}  // namespace calibrd
