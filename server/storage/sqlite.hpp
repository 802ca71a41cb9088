// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "server/storage/storage_error.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace calibrd {

/// An SQLite connection that syncs every commit to the disk. One thread at a time.
class Database {
 public:
  /// Errors: StorageError::cannot_open, not_a_store.
  static Result<Database> open(const std::filesystem::path& file);

  /// Runs statements that give no rows. Error: `why`, with SQLite's words.
  Status run(const std::string& sql, StorageError why);

  std::string words() const;  ///< what SQLite last complained about

 private:
  friend class Statement;
  struct Close {
    void operator()(sqlite3* connection) const;
  };
  std::unique_ptr<sqlite3, Close> connection_;
};

/// One prepared statement: bind values in order, then step through its rows. The first failure is kept for
/// status(); after it, next() is false.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  Statement(const Statement&) = delete;
  ~Statement();

  Statement& bind(const std::string& text);
  Statement& bind(std::int64_t number);
  Statement& bind_null();

  bool next();
  std::string text(int column) const;
  std::optional<std::string> optional_text(int column) const;
  std::optional<std::int64_t> optional_number(int column) const;
  std::int64_t number(int column) const;

  /// Done, or `why` with SQLite's words.
  Status status(StorageError why) const;

 private:
  void check(int code);

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
  std::optional<std::string> failure_;
};

}  // namespace calibrd
