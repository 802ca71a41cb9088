// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace calibrd::api {

/// A file of the page as browsers are given it.
struct PageFile {
  const char* content_type = "";
  std::string bytes;
  std::optional<std::string> gzip;  ///< the same, compressed when the page was built
  std::string etag;                 ///< quoted; of `bytes`
};

/// The page's files: index.html and what lies in assets/, whose names hold a hash of what is in them. Read
/// once, at the start: no request ever becomes a path of the file system. Immutable, safe to read from any
/// thread.
class PageFiles {
 public:
  /// No file where the folder or its index.html is missing: a daemon without its page works.
  static PageFiles read(const std::filesystem::path& folder);

  /// nullptr where the page was not built.
  const PageFile* index() const { return index_ ? &*index_ : nullptr; }
  /// nullptr: there is none of this name.
  const PageFile* asset(std::string_view name) const;

 private:
  std::optional<PageFile> index_;
  std::map<std::string, PageFile, std::less<>> assets_;
};

}  // namespace calibrd::api
