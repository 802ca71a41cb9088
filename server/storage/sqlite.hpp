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
  /// `vfs`: name of the SQLite VFS to go through; empty: the system's. Errors: as run(), with the file's
  /// name.
  static Result<Database> open(const std::filesystem::path& file, const std::string& vfs = {});

  /// Runs statements that give no rows. Errors: see failure().
  Status run(const std::string& sql, StorageError why);

  /// What SQLite last complained about, in its words: full, read_only, damaged, not_a_store or out_of_memory
  /// where it says so, else `why`.
  Error failure(StorageError why) const;

 private:
  friend class Statement;
  friend class Transaction;
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

  /// Done, or the first failure: see Database::failure().
  Status status(StorageError why) const;

 private:
  void check(int code);

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
  mutable std::optional<Error> failure_;  // reading a column can fail, too
};

/// What is written between its making and commit() is stored as a whole, or not at all.
class Transaction {
 public:
  explicit Transaction(Database& database);
  Transaction(const Transaction&) = delete;
  ~Transaction();  ///< undoes what was not committed

  /// Done: it has reached the disk. Errors: see Database::failure().
  Status commit();

 private:
  Database& database_;
  Status begun_;
};

}  // namespace calibrd
