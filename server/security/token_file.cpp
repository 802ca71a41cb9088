// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/token_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>

#include "core/base/utc_text.hpp"
#include "server/security/security_error.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr const char* kFormat = "calibrd-tokens/1";
constexpr mode_t kOwnerOnly = 0600;

Error file_fault(SecurityError why, const fs::path& file) {
  return {why, file.string() + " (" + std::generic_category().message(errno) + ")"};
}

/// Keeps other processes from changing the file between our reading and writing it.
class ChangeLock {
 public:
  explicit ChangeLock(const fs::path& file)
      : number_(::open((file.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerOnly)) {
    holds_ = number_ >= 0 && ::flock(number_, LOCK_EX) == 0;
  }
  ChangeLock(const ChangeLock&) = delete;
  ~ChangeLock() {
    if (number_ >= 0) ::close(number_);
  }
  bool holds() const { return holds_; }

 private:
  const int number_;
  bool holds_ = false;
};

Result<TokenEntry> entry_of(const json::value& value) {
  const auto wrong = Error{SecurityError::tokens_malformed, "tokens"};
  const auto* object = value.if_object();
  if (!object) return wrong;
  const auto text = [&](const char* key) {
    const auto* found = object->if_contains(key);
    return found && found->is_string() ? std::string(found->get_string()) : std::string();
  };
  const auto scope = api::scope_named(text("scope"));
  const auto digest = digest_of_hex(text("sha256"));
  if (!scope || !digest || !check_token_name(text("name"))) return wrong;
  return TokenEntry{text("name"), *scope, *digest, text("created")};
}

Result<std::vector<TokenEntry>> parse_tokens(const std::string& content, const fs::path& file) {
  const Error wrong{SecurityError::tokens_malformed, file.string()};
  boost::system::error_code failure;
  const auto value = json::parse(content, failure);
  const auto* object = failure ? nullptr : value.if_object();
  const auto* format = object ? object->if_contains("format") : nullptr;
  const auto* list = object ? object->if_contains("tokens") : nullptr;
  if (!format || *format != kFormat || !list || !list->is_array()) return wrong;
  std::vector<TokenEntry> entries;
  for (const auto& one : list->get_array()) {
    auto entry = entry_of(one);
    if (!entry) return wrong;
    entries.push_back(*std::move(entry));
  }
  return entries;
}

std::string text_of(const std::vector<TokenEntry>& entries) {
  std::string text = std::string("{\n  \"format\": \"") + kFormat + "\",\n  \"tokens\": [";
  for (const auto& entry : entries) {
    const json::object one{{"name", entry.name},
                           {"scope", api::name_of(entry.scope)},
                           {"sha256", hex_text(entry.digest)},
                           {"created", entry.created}};
    text += std::string(&entry == entries.data() ? "" : ",") + "\n    " + json::serialize(one);
  }
  return text + "\n  ]\n}\n";
}

/// As a whole or not at all, and from its first byte on readable by its owner alone. What was there keeps its
/// owner: root may add a token for the daemon's user.
Status write_tokens(const fs::path& file, const std::vector<TokenEntry>& entries) {
  const auto fresh = file.string() + ".new";
  ::unlink(fresh.c_str());
  const int number = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kOwnerOnly);
  if (number < 0) return file_fault(SecurityError::tokens_not_written, file);
  struct stat old {};
  bool is_well = ::stat(file.c_str(), &old) != 0 || old.st_uid == ::geteuid() ||
                 ::fchown(number, old.st_uid, old.st_gid) == 0;
  const auto text = text_of(entries);
  is_well = is_well && ::write(number, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
            ::fsync(number) == 0;
  const int why = errno;
  ::close(number);
  if (is_well && ::rename(fresh.c_str(), file.c_str()) == 0) return Done{};
  if (!is_well) errno = why;
  const auto error = file_fault(SecurityError::tokens_not_written, file);
  ::unlink(fresh.c_str());
  return error;
}

}  // namespace

std::optional<FileStamp> stamp_of(const fs::path& file) {
  struct stat seen {};
  if (::stat(file.c_str(), &seen) != 0) return std::nullopt;
  return FileStamp{seen.st_ino, seen.st_size,
                   std::int64_t{seen.st_mtim.tv_sec} * 1'000'000'000 + seen.st_mtim.tv_nsec};
}

Result<std::vector<TokenEntry>> read_tokens(const fs::path& file) {
  struct stat seen {};
  if (::stat(file.c_str(), &seen) != 0) {
    if (errno == ENOENT) return std::vector<TokenEntry>();
    return file_fault(SecurityError::tokens_unreadable, file);
  }
  if ((seen.st_mode & 077U) != 0) return Error{SecurityError::tokens_open_to_others, file.string()};
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad()) return file_fault(SecurityError::tokens_unreadable, file);
  return parse_tokens(content, file);
}

Result<std::string> create_token(const fs::path& file, const std::string& name, api::Scope scope) {
  if (auto status = check_token_name(name); !status) return status.error();
  const ChangeLock lock(file);
  if (!lock.holds()) return file_fault(SecurityError::tokens_not_written, file);
  auto entries = read_tokens(file);
  if (!entries) return entries.error();
  if (std::ranges::find(*entries, name, &TokenEntry::name) != entries->end())
    return Error{SecurityError::token_exists, name};
  auto token = new_token();
  if (!token) return token;
  const auto now = utc_text(std::chrono::system_clock::now(), kUtcSeconds) + "Z";
  entries->push_back({name, scope, digest_of(*token), now});
  if (auto status = write_tokens(file, *entries); !status) return status.error();
  return token;
}

Status revoke_token(const fs::path& file, const std::string& name) {
  const ChangeLock lock(file);
  if (!lock.holds()) return file_fault(SecurityError::tokens_not_written, file);
  auto entries = read_tokens(file);
  if (!entries) return entries.error();
  if (std::erase_if(*entries, [&](const auto& entry) { return entry.name == name; }) == 0)
    return Error{SecurityError::no_such_token, name};
  return write_tokens(file, *entries);
}

}  // namespace calibrd
