// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/capture_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "server/storage/durable_file.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".tar";

struct Kept {
  fs::path file;
  std::int64_t modified_s;
  std::uint64_t bytes;
};

std::vector<Kept> oldest_first(const fs::path& folder) {
  std::vector<Kept> all;
  for (const auto& name : names_in(folder)) {
    struct stat facts {};
    const auto file = folder / name;
    // Also what a crash has left half-written: NAME.tar.new
    if (name.find(kEnding) == std::string::npos || ::stat(file.c_str(), &facts) != 0) continue;
    all.push_back({file, facts.st_mtim.tv_sec, static_cast<std::uint64_t>(facts.st_size)});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Kept& a, const Kept& b) { return a.modified_s < b.modified_s; });
  return all;
}

}  // namespace

fs::path capture_folder_of(const fs::path& database) { return database.parent_path() / "captures"; }

CaptureFolder::CaptureFolder(fs::path folder, CaptureLimits limits)
    : folder_(std::move(folder)), limits_(limits) {
  std::error_code ignored;
  fs::remove_all(scratch(), ignored);
}

fs::path CaptureFolder::scratch() const { return folder_ / ".making"; }

fs::path CaptureFolder::file_of(const std::string& calibration_id) const {
  return folder_ / (calibration_id + kEnding);
}

Status CaptureFolder::keep(const std::string& calibration_id, std::string_view tar) {
  if (limits_.age.count() <= 0 || tar.size() > limits_.bytes) return Done{};
  remove_old(tar.size());
  if (auto made = make_folders_durably(folder_); !made) return made;
  return write_durably(file_of(calibration_id), tar);
}

std::optional<std::uint64_t> CaptureFolder::size(const std::string& calibration_id) const {
  struct stat facts {};
  if (::stat(file_of(calibration_id).c_str(), &facts) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(facts.st_size);
}

Result<std::string> CaptureFolder::read(const std::string& calibration_id) const {
  std::ifstream stream(file_of(calibration_id), std::ios::binary);
  std::string tar{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad())
    return file_error(errno, file_of(calibration_id), StorageError::cannot_read);
  return tar;
}

/// A wall clock that leaps ahead while the daemon runs makes nothing old at once.
std::chrono::system_clock::time_point CaptureFolder::now() const {
  const auto passed = std::chrono::steady_clock::now() - opened_steady_;
  return std::min(std::chrono::system_clock::now(),
                  opened_ + std::chrono::duration_cast<std::chrono::system_clock::duration>(passed));
}

void CaptureFolder::remove_old(std::uint64_t room) {
  const std::lock_guard lock(removing_);
  const auto kept = oldest_first(folder_);
  std::uint64_t bytes = room;
  for (const auto& one : kept) bytes += one.bytes;
  const auto now = std::chrono::duration_cast<std::chrono::seconds>(this->now().time_since_epoch());
  for (const auto& one : kept) {
    const bool is_old = now - std::chrono::seconds(one.modified_s) > limits_.age || !keeps_any();
    if (!is_old && bytes <= limits_.bytes) continue;
    std::error_code ignored;
    fs::remove(one.file, ignored);
    bytes -= one.bytes;
  }
}

}  // namespace calibrd
