// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace calibrd {

struct CaptureLimits {
  std::chrono::milliseconds age = std::chrono::hours(24 * 90);  ///< 0: none are kept
  std::uint64_t bytes = 2'000'000'000;                          ///< of all together; 0: none are kept
};

/// The views of calibrations, a tar archive each, as long as there is time and room for them. Ids must be
/// those of calibrations: they become names of files. Safe to call from any thread. Errors: StorageError.
class CaptureFolder {
 public:
  /// Removes what an earlier daemon has left in scratch().
  CaptureFolder(std::filesystem::path folder, CaptureLimits limits);

  /// For what is being made. Beside what is kept: a service need not be able to write anywhere else.
  std::filesystem::path scratch() const;

  bool keeps_any() const { return limits_.age.count() > 0 && limits_.bytes > 0; }
  /// Makes room for it first.
  Status keep(const std::string& calibration_id, std::string_view tar);
  /// Nothing where it is not kept (any more).
  std::optional<std::uint64_t> size(const std::string& calibration_id) const;
  Result<std::string> read(const std::string& calibration_id) const;

  /// Removes what is too old, then the oldest until the others and `room` more bytes fit.
  void remove_old(std::uint64_t room = 0);

 private:
  std::filesystem::path file_of(const std::string& calibration_id) const;
  std::chrono::system_clock::time_point now() const;

  const std::filesystem::path folder_;
  const CaptureLimits limits_;
  const std::chrono::system_clock::time_point opened_ = std::chrono::system_clock::now();
  const std::chrono::steady_clock::time_point opened_steady_ = std::chrono::steady_clock::now();
  std::mutex removing_;
};

/// captures/ beside the database.
std::filesystem::path capture_folder_of(const std::filesystem::path& database);

}  // namespace calibrd
