// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/token_store.hpp"

#include <algorithm>

namespace calibrd {
namespace {

constexpr auto kLookAgainAfter = std::chrono::milliseconds(500);

using Entries = std::vector<TokenEntry>;

bool holds(const Entries& entries, const TokenEntry& wanted) {
  return std::ranges::any_of(entries, [&](const TokenEntry& entry) {
    return entry.name == wanted.name && entry.scope == wanted.scope && entry.digest == wanted.digest;
  });
}

/// What is in `now` and was not in `before` is made, what was and is no longer is revoked: a token of another
/// scope or digest under the same name is both.
std::string change_between(const Entries& before, const Entries& now) {
  std::string change;
  const auto add = [&](const char* what, const TokenEntry& entry) {
    change += std::string(change.empty() ? "" : ", ") + what + " " + entry.name + " (" +
              api::name_of(entry.scope) + ")";
  };
  for (const auto& entry : now)
    if (!holds(before, entry)) add("made", entry);
  for (const auto& entry : before)
    if (!holds(now, entry)) add("revoked", entry);
  return change;
}

}  // namespace

Result<std::shared_ptr<TokenStore>> TokenStore::open(const std::filesystem::path& file, Log log,
                                                     OnChange on_change) {
  std::shared_ptr<TokenStore> store(new TokenStore(file, std::move(log), std::move(on_change)));
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
    if (on_change_) on_change_(entries.error().message(), false);
    return;
  }
  const auto change = change_between(entries_, *entries);
  entries_ = *std::move(entries);
  if (on_change_ && !change.empty()) on_change_(change, true);
  tell(file_.string() + ": " + std::to_string(entries_.size()) + " tokens from now on", true);
}

void TokenStore::tell(const std::string& message, bool is_well) const {
  if (log_) log_(message, is_well);
}

}  // namespace calibrd
