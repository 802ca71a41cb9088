// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sqlite3.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/server/storage/disk_model.hpp"

namespace calibrd {

/// What SQLite asks of the system.
enum class VfsCall { open, read, write, truncate, sync, remove, size, lock, shm_map, shm_lock };
inline constexpr std::size_t kVfsCalls = 10;
const char* name_of(VfsCall call);

/// The system as SQLite sees it, on real files, with the faults a test asks for. One thread, one store.
class TestVfs {
 public:
  static constexpr const char* kName = "calibrd-test";

  TestVfs();
  TestVfs(const TestVfs&) = delete;
  ~TestVfs();

  /// The n-th call of this kind from now on, counted from 1, fails with this SQLite code. `for_good`: and
  /// every one after it.
  void fail(VfsCall call, int n, int code, bool for_good = false);
  void heal();
  bool has_failed() const { return has_failed_; }
  int count(VfsCall call) const { return counts_.at(static_cast<std::size_t>(call)); }

  /// The power fails just before the n-th change of the disk (write, truncation, sync, file made or removed),
  /// counted from 1. From then on every call fails.
  void cut_power(int change) { cut_at_ = change; }
  bool is_off() const { return is_off_; }
  int changes() const { return changes_; }
  const DiskModel& disk() const { return disk_; }

  // For the functions that SQLite calls.
  int enter(VfsCall call);
  int change();
  DiskModel& mutable_disk() { return disk_; }

 private:
  struct Fault {
    VfsCall call;
    int left;
    int code;
    bool for_good;
  };
  sqlite3_vfs vfs_{};
  DiskModel disk_;
  std::optional<Fault> fault_;
  std::array<int, kVfsCalls> counts_{};
  std::optional<int> cut_at_;
  int changes_ = 0;
  bool is_off_ = false, has_failed_ = false;
};

}  // namespace calibrd
