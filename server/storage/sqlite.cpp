// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/sqlite.hpp"

#include <sqlite3.h>

namespace calibrd {
namespace {

constexpr int kBusyTimeout_ms = 2000;

}  // namespace

void Database::Close::operator()(sqlite3* connection) const { sqlite3_close(connection); }

Result<Database> Database::open(const std::filesystem::path& file) {
  Database database;
  sqlite3* connection = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &connection, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  database.connection_.reset(connection);
  if (code != SQLITE_OK)
    return Error{StorageError::cannot_open, file.string() + " (" + database.words() + ")"};
  sqlite3_busy_timeout(connection, kBusyTimeout_ms);
  auto settings =
      database.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;",
                   StorageError::cannot_open);
  if (!settings) {
    const bool foreign =
        sqlite3_errcode(connection) == SQLITE_NOTADB || sqlite3_errcode(connection) == SQLITE_CORRUPT;
    return Error{foreign ? StorageError::not_a_store : StorageError::cannot_open,
                 file.string() + " (" + settings.error().detail + ")"};
  }
  return database;
}

Status Database::run(const std::string& sql, StorageError why) {
  if (sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    return Error{why, words()};
  return Done{};
}

std::string Database::words() const { return sqlite3_errmsg(connection_.get()); }

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
  if (code != SQLITE_DONE) failure_ = database_.words();
  return false;
}

std::optional<std::string> Statement::optional_text(int column) const {
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return size == 0 ? std::string() : std::string(bytes, size);
}

std::string Statement::text(int column) const { return optional_text(column).value_or(""); }

std::optional<std::int64_t> Statement::optional_number(int column) const {
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
  return sqlite3_column_int64(statement_, column);
}

std::int64_t Statement::number(int column) const { return sqlite3_column_int64(statement_, column); }

Status Statement::status(StorageError why) const {
  if (failure_) return Error{why, *failure_};
  return Done{};
}

void Statement::check(int code) {
  if (code != SQLITE_OK && !failure_) failure_ = database_.words();
}

}  // namespace calibrd
