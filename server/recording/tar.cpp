// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/recording/tar.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numeric>
#include <vector>

namespace calibrd {
namespace {

// Field offsets and sizes of a ustar header (POSIX.1-1988).
constexpr std::size_t kBlock = 512;
constexpr std::size_t kNameSize = 100, kPrefixSize = 155;
constexpr std::size_t kMode = 100, kOwner = 108, kGroup = 116, kLength = 124, kModified = 136,
                      kChecksum = 148;
constexpr std::size_t kType = 156, kMagic = 257, kPrefix = 345;

void put(std::string& header, std::size_t offset, std::string_view text) {
  std::copy(text.begin(), text.end(), header.begin() + static_cast<std::ptrdiff_t>(offset));
}

void put_octal(std::string& header, std::size_t offset, int digits, std::uint64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%0*llo", digits, static_cast<unsigned long long>(number));
  put(header, offset, text);
}

/// Where a name splits into prefix and name; npos when it cannot.
std::size_t split_at(const std::string& name) {
  if (name.size() <= kNameSize) return 0;
  const auto slash = name.find('/', name.size() - kNameSize - 1);
  return slash == std::string::npos || slash > kPrefixSize ? std::string::npos : slash;
}

std::string pad(std::size_t size) { return std::string((kBlock - size % kBlock) % kBlock, '\0'); }

}  // namespace

bool TarWriter::add_file(const std::string& name, std::string_view content, std::int64_t modified_s) {
  const auto split = split_at(name);
  if (split == std::string::npos || name.empty()) return false;
  std::string header(kBlock, '\0');
  put(header, 0, split == 0 ? name : name.substr(split + 1));
  if (split != 0) put(header, kPrefix, name.substr(0, split));
  put_octal(header, kMode, 7, 0644);
  put_octal(header, kOwner, 7, 0);
  put_octal(header, kGroup, 7, 0);
  put_octal(header, kLength, 11, content.size());
  put_octal(header, kModified, 11, static_cast<std::uint64_t>(std::max<std::int64_t>(modified_s, 0)));
  header[kType] = '0';
  put(header, kMagic,
      std::string_view("ustar\0"
                       "00",
                       8));
  put(header, kChecksum, "        ");
  const auto sum = std::accumulate(header.begin(), header.end(), std::uint64_t{0},
                                   [](std::uint64_t s, char c) { return s + static_cast<unsigned char>(c); });
  put_octal(header, kChecksum, 6, sum);
  header[kChecksum + 6] = '\0';
  archive_.append(header).append(content).append(pad(content.size()));
  return true;
}

std::string TarWriter::take() {
  archive_.append(2 * kBlock, '\0');
  return std::move(archive_);
}

Result<std::string> tar_of_folder(const std::filesystem::path& folder, const std::string& prefix) {
  std::error_code failure;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure))
    if (entry->is_regular_file()) files.push_back(entry->path());
  if (failure) return Error{failure, folder.string()};
  std::sort(files.begin(), files.end());
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  TarWriter tar;
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(stream), {}};
    if (!stream.is_open() || stream.bad())
      return Error{std::make_error_code(std::errc::io_error), file.string()};
    if (!tar.add_file(prefix + "/" + file.lexically_relative(folder).generic_string(), content, now))
      return Error{std::make_error_code(std::errc::filename_too_long), file.string()};
  }
  return tar.take();
}

}  // namespace calibrd
