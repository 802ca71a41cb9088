// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "fleet/collector/inbox.hpp"
#include "fleet/collector/warehouse_error.hpp"

struct pg_conn;

namespace calibrd::fleet {

/// The history of all cells in PostgreSQL. One thread at a time. Errors: WarehouseError, with PostgreSQL's words.
class Warehouse {
 public:
  /// `database`: as libpq takes it: "host=… dbname=… user=… passfile=…", a URI, or "service=…". Connects when it is first
  /// needed, and again after the connection was lost.
  explicit Warehouse(std::string database) : database_(std::move(database)) {}

  /// Brings the tables up to date. Several collectors may do so at a time.
  Status prepare();

  /// Stores all of them, or none; those that are there already count as stored. Done: they are on PostgreSQL's disk.
  /// WarehouseError::unfit: one of them can never be.
  Status store(const std::vector<Arrival>& arrivals);

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  Status connect();
  Status run(const std::string& sql, WarehouseError why);
  Result<int> schema_version();

  std::string database_;
  std::unique_ptr<pg_conn, Close> connection_;
};

}  // namespace calibrd::fleet
