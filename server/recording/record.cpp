// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/recording/record.hpp"

#include <stdlib.h>

#include "api/problem/api_error.hpp"
#include "core/base/utc_text.hpp"
#include "server/recording/pack_robot.hpp"
#include "server/recording/tar.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

/// A folder of its own below another, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& parent) {
    std::error_code failure;
    fs::create_directories(parent, failure);
    auto name = (parent / "capture.XXXXXX").string();
    if (!failure && mkdtemp(name.data()) != nullptr) path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Error translated(const Error& error) { return fail(api::ApiError::capture_failed, error.message()); }

}  // namespace

Result<api::CaptureArchive> archive_capture(const Capture& capture, std::span<const fs::path> search_paths,
                                            const fs::path& scratch) {
  const TemporaryFolder temporary(scratch);
  if (temporary.path().empty())
    return fail(api::ApiError::capture_failed, "no folder can be made in " + scratch.string());
  const auto name = capture.sensor_id + "-" + utc_text(std::chrono::system_clock::now(), kUtcCompact);
  const auto folder = temporary.path() / name;
  if (auto written = write_capture(folder, capture, "robot.urdf"); !written)
    return translated(written.error());
  if (auto packed = pack_robot(capture.urdf, search_paths, folder); !packed)
    return translated(packed.error());
  auto tar = tar_of_folder(folder, name);
  if (!tar) return translated(tar.error());
  return api::CaptureArchive{name + ".tar", *std::move(tar)};
}

}  // namespace calibrd
