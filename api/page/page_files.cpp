// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/page/page_files.hpp"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <utility>

namespace calibrd::api {
namespace {

namespace fs = std::filesystem;

constexpr std::array kContentTypes{
    std::pair{".html", "text/html; charset=utf-8"}, std::pair{".js", "text/javascript; charset=utf-8"},
    std::pair{".css", "text/css; charset=utf-8"}, std::pair{".svg", "image/svg+xml"}};

/// nullptr: no file that a page is made of.
const char* content_type(const fs::path& file) {
  for (const auto& [extension, type] : kContentTypes)
    if (file.extension() == extension) return type;
  return nullptr;
}

std::optional<std::string> read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// FNV-1a: tells versions of a file apart and guards against nothing.
std::string etag_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  std::string hex;
  for (int shift = 60; shift >= 0; shift -= 4) hex += "0123456789abcdef"[(hash >> shift) & 0xfU];
  return '"' + hex + '"';
}

std::optional<PageFile> read_file(const fs::path& path) {
  const auto* type = content_type(path);
  auto bytes = type ? read_bytes(path) : std::nullopt;
  if (!bytes) return std::nullopt;
  auto etag = etag_of(*bytes);
  return PageFile{type, *std::move(bytes), read_bytes(path.string() + ".gz"), std::move(etag)};
}

}  // namespace

PageFiles PageFiles::read(const fs::path& folder) {
  PageFiles files;
  files.index_ = read_file(folder / "index.html");
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder / "assets", missing))
    if (entry.is_regular_file(missing))
      if (auto file = read_file(entry.path()))
        files.assets_.emplace(entry.path().filename().string(), *std::move(file));
  return files;
}

const PageFile* PageFiles::asset(std::string_view name) const {
  const auto found = assets_.find(name);
  return found == assets_.end() ? nullptr : &found->second;
}

}  // namespace calibrd::api
