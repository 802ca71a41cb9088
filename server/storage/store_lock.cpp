// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/store_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "server/storage/durable_file.hpp"

namespace calibrd {

Result<StoreLock> StoreLock::take(const std::filesystem::path& database) {
  std::error_code failure;
  auto file = std::filesystem::weakly_canonical(database, failure);  // one lock, whatever links lead there
  if (failure) return Error{StorageError::cannot_open, database.string() + " (" + failure.message() + ")"};
  file += ".lock";
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const int opened = errno;
  if (descriptor < 0) return file_error(opened, file, StorageError::cannot_open);
  StoreLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) return Error{StorageError::in_use, database.string()};
  return lock;
}

StoreLock::StoreLock(StoreLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

StoreLock::~StoreLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace calibrd
