// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/token_store.hpp"

namespace calibrd {
namespace {

constexpr auto kLookAgainAfter = std::chrono::milliseconds(500);

}  // namespace

Result<std::shared_ptr<TokenStore>> TokenStore::open(const std::filesystem::path& file, Log log) {
  std::shared_ptr<TokenStore> store(new TokenStore(file, std::move(log)));
  store->stamp_ = stamp_of(file);
  auto entries = read_tokens(file);
  if (!entries) return entries.error();
  store->entries_ = *std::move(entries);
  store->looked_ = std::chrono::steady_clock::now();
  if (store->entries_.empty())
    store->tell(
        file.string() + " holds no token yet: every request is refused; make one with `calibrd token create`",
        false);
  return store;
}

std::optional<api::Caller> TokenStore::find(std::string_view token) {
  if (std::chrono::steady_clock::now() - looked_ > kLookAgainAfter) refresh();
  const auto digest = digest_of(token);
  const TokenEntry* found = nullptr;
  for (const auto& entry : entries_)  // to the end, always: time tells nothing
    if (is_same(entry.digest, digest)) found = &entry;
  if (!found) return std::nullopt;
  return api::Caller{found->name, found->scope};
}

void TokenStore::refresh() {
  looked_ = std::chrono::steady_clock::now();
  const auto stamp = stamp_of(file_);
  if (stamp == stamp_) return;
  stamp_ = stamp;
  auto entries = read_tokens(file_);
  if (!entries) {  // an editor's mistake must not lock the cell out
    tell("the tokens stay as they were: " + entries.error().message(), false);
    return;
  }
  entries_ = *std::move(entries);
  tell(file_.string() + ": " + std::to_string(entries_.size()) + " tokens from now on", true);
}

void TokenStore::tell(const std::string& message, bool is_well) const {
  if (log_) log_(message, is_well);
}

}  // namespace calibrd
