// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unistd.h>

#include <filesystem>
#include <string>

namespace calibrd {

/// A folder of a test's own, in memory where there is such a place: thousands of syncs to a disk take
/// minutes.
class StorageFolder {
 public:
  StorageFolder() {
    const std::filesystem::path memory = "/dev/shm";
    const auto root = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    path_ = root / ("calibrd_storage_" + std::to_string(getpid()));
    clear();
  }
  StorageFolder(const StorageFolder&) = delete;
  ~StorageFolder() { std::filesystem::remove_all(path_); }

  const std::filesystem::path& path() const { return path_; }
  void clear() const {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace calibrd
