// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/warehouse.hpp"

#include <libpq-fe.h>

#include <boost/json/serialize.hpp>
#include <boost/json/string.hpp>
#include <string_view>

#include "fleet/collector/migrations.hpp"

namespace calibrd::fleet {
namespace {

// Any number: only collectors take this lock.
constexpr const char* kTakeLock = "SELECT pg_advisory_xact_lock(7240917)";

// One statement for a whole batch: its parameter is a JSON array of {"cell", "document"}.
constexpr const char* kInsert = R"sql(
INSERT INTO calibrations (cell, calibration_id, sensor_id, created_at, finished_at, status, verdict, method,
  sigma_position_m, sigma_rotation_rad, software_version, document)
SELECT a ->> 'cell', d ->> 'id', d ->> 'sensor', (d ->> 'created_at')::timestamptz,
  coalesce(d ->> 'finished_at', d ->> 'created_at')::timestamptz, d ->> 'status', d ->> 'verdict', d ->> 'method',
  (d -> 'result' ->> 'sigma_position_m')::double precision, (d -> 'result' ->> 'sigma_rotation_rad')::double precision,
  d ->> 'software_version', d
FROM jsonb_array_elements($1::jsonb) AS arrivals (a), LATERAL (SELECT a -> 'document') AS documents (d)
ON CONFLICT DO NOTHING
)sql";

struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Rows = std::unique_ptr<PGresult, Clear>;

bool is_good(const Rows& rows) {
  const auto status = PQresultStatus(rows.get());
  return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK;
}

/// Classes of SQLSTATE that another try does not change: data exceptions, violated constraints.
bool is_final(const Rows& rows) {
  const char* state = PQresultErrorField(rows.get(), PG_DIAG_SQLSTATE);
  const std::string_view code = state ? state : "";
  return code.starts_with("22") || code.starts_with("23");
}

std::string batch_of(const std::vector<Arrival>& arrivals) {
  std::string batch = "[";
  for (const auto& arrival : arrivals) {
    if (batch.size() > 1) batch += ',';
    batch += R"({"cell":)" + boost::json::serialize(boost::json::string(arrival.cell)) + R"(,"document":)" +
             arrival.document + '}';
  }
  return batch + ']';
}

}  // namespace

void Warehouse::Close::operator()(pg_conn* connection) const { PQfinish(connection); }

Status Warehouse::connect() {
  if (connection_ && PQstatus(connection_.get()) == CONNECTION_OK) return Done{};
  connection_.reset(PQconnectdb(database_.c_str()));
  if (PQstatus(connection_.get()) == CONNECTION_OK) {
    PQsetNoticeProcessor(connection_.get(), [](void*, const char*) {}, nullptr);
    return run("SET synchronous_commit TO on", WarehouseError::no_connection);
  }
  return Error{WarehouseError::no_connection, PQerrorMessage(connection_.get())};
}

Status Warehouse::run(const std::string& sql, WarehouseError why) {
  const Rows rows(PQexec(connection_.get(), sql.c_str()));
  if (is_good(rows)) return Done{};
  return Error{why, PQerrorMessage(connection_.get())};
}

Result<int> Warehouse::schema_version() {
  const Rows rows(PQexec(connection_.get(), "SELECT coalesce(max(version), 0) FROM calibrd_schema"));
  if (!is_good(rows)) return Error{WarehouseError::cannot_migrate, PQerrorMessage(connection_.get())};
  return std::stoi(PQgetvalue(rows.get(), 0, 0));
}

Status Warehouse::prepare() {
  if (auto status = connect(); !status) return status;
  const auto steps = [this]() -> Status {
    constexpr auto why = WarehouseError::cannot_migrate;
    if (auto status = run(kTakeLock, why); !status) return status;
    if (auto status = run("CREATE TABLE IF NOT EXISTS calibrd_schema (version integer PRIMARY KEY, "
                          "taken_at timestamptz NOT NULL DEFAULT now())", why); !status)
      return status;
    const auto version = schema_version();
    if (!version) return version.error();
    const auto all = migrations();
    if (*version > static_cast<int>(all.size()))
      return Error{WarehouseError::newer_schema, "schema " + std::to_string(*version)};
    for (auto step = static_cast<std::size_t>(*version); step < all.size(); ++step) {
      if (auto status = run(all[step], why); !status) return status;
      const auto number = std::to_string(step + 1);
      if (auto status = run("INSERT INTO calibrd_schema (version) VALUES (" + number + ")", why); !status)
        return status;
    }
    return run("COMMIT", why);
  };
  if (auto status = run("BEGIN", WarehouseError::cannot_migrate); !status) return status;
  auto status = steps();
  if (!status) static_cast<void>(run("ROLLBACK", WarehouseError::cannot_migrate));
  return status;
}

Status Warehouse::store(const std::vector<Arrival>& arrivals) {
  if (auto status = connect(); !status) return status;
  const auto batch = batch_of(arrivals);
  const char* values[] = {batch.c_str()};
  const Rows rows(PQexecParams(connection_.get(), kInsert, 1, nullptr, values, nullptr, nullptr, 0));
  if (is_good(rows)) return Done{};
  const Error error{is_final(rows) ? WarehouseError::unfit : WarehouseError::cannot_store,
                    PQerrorMessage(connection_.get())};
  return error;
}

}  // namespace calibrd::fleet
