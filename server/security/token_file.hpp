// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/security/token.hpp"

namespace calibrd {

/// Tells versions of a file apart without reading it.
struct FileStamp {
  std::uint64_t inode = 0;
  std::int64_t size = -1, changed_ns = 0;
  bool operator==(const FileStamp&) const = default;
};

/// Nothing where there is no such file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& file);

/// The tokens in a file; none where there is no file. Errors: SecurityError::tokens_unreadable,
/// tokens_malformed, and tokens_open_to_others, naming the file.
Result<std::vector<TokenEntry>> read_tokens(const std::filesystem::path& file);

/// Adds a token to the file, which is made where it is not there (mode 0600), and returns the token itself:
/// it is kept nowhere. Safe beside other processes that do the same. Errors: SecurityError.
Result<std::string> create_token(const std::filesystem::path& file, const std::string& name,
                                 api::Scope scope);

/// Errors: SecurityError::no_such_token and those of reading and writing.
Status revoke_token(const std::filesystem::path& file, const std::string& name);

}  // namespace calibrd
