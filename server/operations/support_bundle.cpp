// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/support_bundle.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <sstream>

#include "core/base/utc_text.hpp"
#include "server/recording/tar.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr std::array kSecretWords{"token", "secret", "password", "passphrase", "credential", "key"};
constexpr const char* kReadMe =
    "What calibrd knows of itself, for somebody who is to help. Secrets of the configuration are left out.\n"
    "config.toml: the configuration in effect. readyz.json: what is missing. metrics.txt: docs/metrics.md.\n"
    "cell.json, sensors/: robot, sensors, poses, drift and the newest calibrations as docs/api.md says.\n"
    "captures.txt: views of calibrations that are kept on the machine; captures/: the newest of them, to be\n"
    "unpacked and given to `calibrd calibrate`. log.txt: the newest lines of the log. audit.log: the end of "
    "the\n"
    "audit log, where there is one.\n\n";

bool is_secret(const std::string& line) {
  const auto equals = line.find(" = ");
  if (equals == std::string::npos) return false;
  std::string key = line.substr(0, equals);
  std::ranges::transform(key, key.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(kSecretWords,
                             [&](const char* word) { return key.find(word) != std::string::npos; });
}

struct ListedFile {
  fs::file_time_type modified;
  std::uintmax_t bytes = 0;
  std::string name;
};

/// Newest first.
std::vector<ListedFile> files_in(const fs::path& folder) {
  std::vector<ListedFile> files;
  std::error_code failure;
  fs::directory_iterator entry(folder, failure);
  for (; !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
    std::error_code ignored;
    if (!entry->is_regular_file(ignored)) continue;
    files.push_back(
        {entry->last_write_time(ignored), entry->file_size(ignored), entry->path().filename().string()});
  }
  std::ranges::sort(files, std::ranges::greater(), &ListedFile::modified);
  return files;
}

std::string time_of(fs::file_time_type modified) {
  const auto time = std::chrono::file_clock::to_sys(modified);
  return utc_text(std::chrono::time_point_cast<std::chrono::system_clock::duration>(time), kUtcSeconds) + "Z";
}

}  // namespace

std::string without_secrets(const std::string& toml) {
  std::istringstream lines(toml);
  std::string text;
  for (std::string line; std::getline(lines, line);)
    text += (is_secret(line) ? line.substr(0, line.find(" = ")) + " = \"(left out)\"" : line) + "\n";
  return text;
}

std::string end_of_file(const fs::path& file, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return {};
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, stream.tellg()));
  const bool is_cut = size > bytes;
  stream.seekg(static_cast<std::streamoff>(is_cut ? size - bytes : 0));
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (is_cut) text.erase(0, std::min(text.find('\n'), text.size() - 1) + 1);
  return text;
}

std::string list_of_files(const fs::path& folder, std::size_t most) {
  auto files = files_in(folder);
  std::string text = folder.string() + ": " + std::to_string(files.size()) + " files\n";
  files.resize(std::min(files.size(), most));
  for (const auto& file : files)
    text += time_of(file.modified) + " " + std::to_string(file.bytes) + " " + file.name + "\n";
  return text;
}

BundleFiles newest_captures(const fs::path& folder, std::uintmax_t bytes) {
  BundleFiles captures;
  for (const auto& file : files_in(folder)) {
    if (file.bytes > bytes) break;
    // Kept ones are removed at any time, by age and size: what cannot be read any more is left out.
    std::ifstream stream(folder / file.name, std::ios::binary);
    captures.emplace_back("captures/" + file.name, std::string{std::istreambuf_iterator<char>(stream), {}});
    bytes -= file.bytes;
  }
  return captures;
}

api::CaptureArchive bundle_of(const BundleFiles& files, api::SystemTime now) {
  const auto name = "calibrd-support-" + utc_text(now, kUtcCompact);
  const auto modified_s = static_cast<std::int64_t>(std::chrono::system_clock::to_time_t(now));
  TarWriter tar;
  std::string contents = kReadMe;
  for (const auto& [file, content] : files) {
    if (content.empty()) continue;
    const bool fits = tar.add_file(name + "/" + file, content, modified_s);
    contents += file + (fits ? "\n" : ": left out, its name is too long\n");
  }
  tar.add_file(name + "/README.txt", contents, modified_s);
  return {name + ".tar", tar.take()};
}

}  // namespace calibrd
