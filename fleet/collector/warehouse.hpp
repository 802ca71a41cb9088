// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "fleet/collector/inbox.hpp"
#include "fleet/collector/warehouse_error.hpp"

struct pg_conn;
struct pg_result;

namespace calibrd::fleet {

/// The history of all cells in PostgreSQL. One thread at a time. Errors: WarehouseError, with PostgreSQL's
/// words.
class Warehouse {
 public:
  /// `database`: as libpq takes it: "host=… dbname=… user=… passfile=…", a URI, or "service=…". Connects when
  /// it is first needed, and again after the connection was lost.
  explicit Warehouse(std::string database) : database_(std::move(database)) {}

  /// A server that does not answer is given up when `is_ending` says so, which is asked several times a
  /// second.
  void end_when(std::function<bool()> is_ending) { is_ending_ = std::move(is_ending); }

  bool is_connected() const;

  /// Brings the tables up to date. Several collectors may do so at a time.
  Status prepare();

  /// Stores all of them, or none; those that are there already count as stored. Done: they are on
  /// PostgreSQL's disk. WarehouseError::unfit: one of them can never be.
  Status store(const std::vector<Arrival>& arrivals);

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  struct Clear {
    void operator()(pg_result* result) const;
  };
  using Rows = std::unique_ptr<pg_result, Clear>;

  Status connect();
  Rows ask(const std::string& sql);
  Rows answer();
  bool wait_for_server();
  Status run(const std::string& sql, WarehouseError why);
  Result<int> schema_version();

  std::string database_;
  std::function<bool()> is_ending_ = [] { return false; };
  std::unique_ptr<pg_conn, Close> connection_;
};

}  // namespace calibrd::fleet
