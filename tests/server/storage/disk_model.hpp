// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace calibrd {

/// What a disk is sure to hold, and what it may: writes, truncations, new and removed names stay open until
/// they are synced. Follows what a program does to its files; tells what a power cut leaves of them.
class DiskModel {
 public:
  void create(const std::filesystem::path& file);
  void write(const std::filesystem::path& file, std::int64_t offset, std::string bytes);
  void truncate(const std::filesystem::path& file, std::int64_t size);
  void sync(const std::filesystem::path& file);
  void sync_names();  ///< of the folder: files that were made and removed
  void remove(const std::filesystem::path& file);

  /// The files as they are after a power cut, into another folder. Every sector, truncation and name that was
  /// not synced has reached the disk with probability `kept`, in whatever order.
  void write_remains(const std::filesystem::path& folder, double kept, std::mt19937& random) const;

 private:
  struct Change {
    std::int64_t offset;
    std::string bytes;
    bool is_truncation = false;
  };
  struct File {
    std::string synced;
    std::vector<Change> open;
  };
  using Names = std::map<std::filesystem::path, std::shared_ptr<File>>;

  static void apply(const Change& change, std::string& content);
  static std::string remains(const File& file, double kept, std::mt19937& random);

  Names names_, synced_names_;
};

}  // namespace calibrd
