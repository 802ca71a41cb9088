// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace calibrd {

/// A tar archive (POSIX ustar) that grows in memory.
class TarWriter {
 public:
  /// `name`: with '/' between folders, at most 255 bytes. False when the name does not fit the format.
  bool add_file(const std::string& name, std::string_view content, std::int64_t modified_s);

  /// Ends the archive and gives it away.
  std::string take();

 private:
  std::string archive_;
};

/// Every file below `folder`, its names beginning with `prefix`, in sorted order.
/// Error: std::errc of the file system, the detail naming the file.
Result<std::string> tar_of_folder(const std::filesystem::path& folder, const std::string& prefix);

}  // namespace calibrd
