// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "core/base/result.hpp"

namespace calibrd {

/// Keeps every other process from using a store: two daemons on one store would end each other's
/// calibrations. Held on a file beside the database ("calibrd.db.lock"), which stays; the kernel lets go when
/// the process ends, however it does. Not on the database itself: closing a second descriptor of it would
/// drop SQLite's own locks.
class StoreLock {
 public:
  /// Errors: StorageError::in_use, cannot_open.
  static Result<StoreLock> take(const std::filesystem::path& database);

  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&&) = delete;
  ~StoreLock();

 private:
  explicit StoreLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace calibrd
