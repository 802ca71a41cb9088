// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/file_bytes.hpp"

#include <algorithm>
#include <fstream>

#include "core/capture/capture_error.hpp"

namespace calibrd {

namespace fs = std::filesystem;

Result<std::string> read_bytes(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    return fail(CaptureError::unreadable, path.string() + " (" + error.message() + ")");
  if (!fs::is_regular_file(status)) return fail(CaptureError::unreadable, path.string() + " (not a file)");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return fail(CaptureError::unreadable, path.string() + " (" + error.message() + ")");
  if (size > max_bytes)
    return fail(CaptureError::file_too_large, path.string() + " (" + std::to_string(size) +
                                                  " bytes, at most " + std::to_string(max_bytes) + ")");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!file) return fail(CaptureError::unreadable, path.string());
  return bytes;
}

Result<fs::path> path_inside(const fs::path& folder, const std::string& name) {
  const fs::path relative(name);
  const bool leaves = relative.is_absolute() || std::ranges::find(relative, fs::path("..")) != relative.end();
  const bool is_cut = name.find('\0') != std::string::npos;  // the system would read up to there
  if (name.empty() || leaves || is_cut) return fail(CaptureError::path_outside, "\"" + name + "\"");
  return folder / relative;
}

}  // namespace calibrd
