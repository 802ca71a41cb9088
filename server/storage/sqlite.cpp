// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/sqlite.hpp"

#include <sqlite3.h>

#include <cerrno>

namespace calibrd {
namespace {

constexpr int kBusyTimeout_ms = 2000;

/// `system_errno`: of the call that failed, where it was one.
StorageError translated(int code, int system_errno, StorageError why) {
  const bool is_io = code == SQLITE_IOERR || code == SQLITE_CANTOPEN;
  if (code == SQLITE_FULL || (is_io && (system_errno == ENOSPC || system_errno == EDQUOT)))
    return StorageError::full;
  if (code == SQLITE_READONLY || (is_io && system_errno == EROFS)) return StorageError::read_only;
  if (code == SQLITE_CORRUPT) return StorageError::damaged;
  if (code == SQLITE_NOTADB) return StorageError::not_a_store;
  if (code == SQLITE_NOMEM) return StorageError::out_of_memory;
  if (code == SQLITE_CONSTRAINT) return StorageError::contradiction;
  return why;
}

}  // namespace

void Database::Close::operator()(sqlite3* connection) const { sqlite3_close(connection); }

Result<Database> Database::open(const std::filesystem::path& file, const std::string& vfs) {
  Database database;
  sqlite3* connection = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &connection, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
                                   vfs.empty() ? nullptr : vfs.c_str());
  database.connection_.reset(connection);
  Status settings = Done{};
  if (code == SQLITE_OK) {
    sqlite3_busy_timeout(connection, kBusyTimeout_ms);
    settings = database.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;",
                            StorageError::cannot_open);
  } else {
    settings = database.failure(StorageError::cannot_open);
  }
  if (!settings) return Error{settings.error().code, file.string() + " (" + settings.error().detail + ")"};
  return database;
}

Status Database::run(const std::string& sql, StorageError why) {
  if (sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    return failure(why);
  return Done{};
}

Error Database::failure(StorageError why) const {
  const int cause = sqlite3_system_errno(connection_.get());
  return {translated(sqlite3_errcode(connection_.get()), cause, why), sqlite3_errmsg(connection_.get())};
}

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  check(sqlite3_prepare_v2(database.connection_.get(), sql.c_str(), -1, &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(const std::string& text) {
  check(
      sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind(std::int64_t number) {
  check(sqlite3_bind_int64(statement_, ++bound_, number));
  return *this;
}

Statement& Statement::bind_null() {
  check(sqlite3_bind_null(statement_, ++bound_));
  return *this;
}

bool Statement::next() {
  if (failure_) return false;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) failure_ = database_.failure(StorageError::cannot_read);
  return false;
}

std::optional<std::string> Statement::optional_text(int column) const {
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  if (bytes == nullptr && size != 0) {  // SQLite had no memory to bring it here
    failure_ = database_.failure(StorageError::out_of_memory);
    return std::nullopt;
  }
  return size == 0 ? std::string() : std::string(bytes, size);
}

std::string Statement::text(int column) const { return optional_text(column).value_or(""); }

std::optional<std::int64_t> Statement::optional_number(int column) const {
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
  return sqlite3_column_int64(statement_, column);
}

std::int64_t Statement::number(int column) const { return sqlite3_column_int64(statement_, column); }

Status Statement::status(StorageError why) const {
  if (!failure_) return Done{};
  const bool is_plain = failure_->code == StorageError::cannot_read;
  return Error{is_plain ? make_error_code(why) : failure_->code, failure_->detail};
}

void Statement::check(int code) {
  if (code != SQLITE_OK && !failure_) failure_ = database_.failure(StorageError::cannot_read);
}

Transaction::Transaction(Database& database)
    : database_(database), begun_(database.run("BEGIN IMMEDIATE", StorageError::cannot_write)) {}

/// After some failures SQLite has undone it already; saying so twice does no harm.
Transaction::~Transaction() {
  if (sqlite3_get_autocommit(database_.connection_.get()) == 0)
    sqlite3_exec(database_.connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Status Transaction::commit() {
  if (!begun_) return begun_;
  return database_.run("COMMIT", StorageError::cannot_write);
}

}  // namespace calibrd
