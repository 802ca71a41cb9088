// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>
#include <memory>

#include "api/access/authenticator.hpp"
#include "server/security/token_file.hpp"

namespace calibrd {

/// The tokens of a file, which is looked at again while the daemon runs: what is created or revoked counts
/// within half a second. One thread at a time.
class TokenStore : public api::Authenticator {
 public:
  using Log = std::function<void(const std::string& message, bool is_well)>;
  /// "made hmi (calibrate), revoked old", or why the file was not taken over. Must not wait.
  using OnChange = std::function<void(const std::string& what, bool is_done)>;

  /// Errors: those of read_tokens(). Without a file there are no tokens.
  static Result<std::shared_ptr<TokenStore>> open(const std::filesystem::path& file, Log log = {},
                                                  OnChange on_change = {});

  std::optional<api::Caller> find(std::string_view token) override;

  /// Looks at the file now.
  void refresh();
  std::size_t size() const { return entries_.size(); }

 private:
  TokenStore(std::filesystem::path file, Log log, OnChange on_change)
      : file_(std::move(file)), log_(std::move(log)), on_change_(std::move(on_change)) {}
  void tell(const std::string& message, bool is_well) const;

  const std::filesystem::path file_;
  const Log log_;
  const OnChange on_change_;
  std::optional<FileStamp> stamp_;
  std::vector<TokenEntry> entries_;
  std::chrono::steady_clock::time_point looked_;
};

}  // namespace calibrd
