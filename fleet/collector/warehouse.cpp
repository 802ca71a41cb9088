// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/warehouse.hpp"

#include <libpq-fe.h>
#include <poll.h>

#include <array>
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

constexpr int kPeriod_ms = 200;

// A host that vanishes is noticed within some 20 s: the kernel's own patience is a quarter of an hour.
constexpr std::array kNames{"keepalives_idle", "keepalives_interval", "keepalives_count", "tcp_user_timeout"};
constexpr std::array kValues{"10", "3", "3", "15000"};

bool is_good(const PGresult* rows) {
  const auto status = PQresultStatus(rows);
  return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK;
}

/// Classes of SQLSTATE that another try does not change: data exceptions, violated constraints, exceeded
/// limits.
bool is_final(const PGresult* rows) {
  const char* state = PQresultErrorField(rows, PG_DIAG_SQLSTATE);
  const std::string_view code = state ? state : "";
  return code.starts_with("22") || code.starts_with("23") || code.starts_with("54");
}

/// Classes of SQLSTATE that are no document's fault: no disk, no memory, read-only, shutting down.
bool is_of_server(const PGresult* rows) {
  const char* state = PQresultErrorField(rows, PG_DIAG_SQLSTATE);
  const std::string_view code = state ? state : "";
  return code.starts_with("53") || code.starts_with("57") || code.starts_with("58") || code.starts_with("25");
}

pg_conn* open_connection(const std::string& database) {
  std::vector<const char*> names(kNames.begin(), kNames.end()), values(kValues.begin(), kValues.end());
  names.insert(names.end(), {"dbname", nullptr});  // last: what it says itself goes before ours
  values.insert(values.end(), {database.c_str(), nullptr});
  return PQconnectdbParams(names.data(), values.data(), 1);
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

void Warehouse::Clear::operator()(PGresult* result) const { PQclear(result); }
void Warehouse::Close::operator()(pg_conn* connection) const { PQfinish(connection); }

bool Warehouse::is_connected() const { return connection_ && PQstatus(connection_.get()) == CONNECTION_OK; }

Status Warehouse::connect() {
  if (is_connected()) return Done{};
  connection_.reset(open_connection(database_));
  if (is_connected()) {
    PQsetnonblocking(connection_.get(), 1);
    PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
    return run("SET synchronous_commit TO on", WarehouseError::no_connection);
  }
  return Error{WarehouseError::no_connection, PQerrorMessage(connection_.get())};
}

Warehouse::Rows Warehouse::ask(const std::string& sql) {
  if (PQsendQuery(connection_.get(), sql.c_str()) == 0) return nullptr;
  return answer();
}

/// The last of the statements' results; nothing where the connection was lost, or given up.
Warehouse::Rows Warehouse::answer() {
  Rows last;
  while (wait_for_server()) {
    Rows next(PQgetResult(connection_.get()));
    if (!next) return last;
    last = std::move(next);
  }
  return nullptr;
}

/// True: a result, or the end of them, can be had without waiting.
bool Warehouse::wait_for_server() {
  auto* connection = connection_.get();
  for (;;) {
    const int unsent = PQflush(connection);
    if (unsent < 0) return false;
    if (unsent == 0 && PQisBusy(connection) == 0) return true;
    pollfd waited{PQsocket(connection), static_cast<short>(unsent > 0 ? POLLIN | POLLOUT : POLLIN), 0};
    poll(&waited, 1, kPeriod_ms);
    if (waited.revents != 0 && PQconsumeInput(connection) == 0) return false;
    if (!is_ending_()) continue;
    connection_.reset();  // the server may be at it still; a transaction that is not committed is none
    return false;
  }
}

Status Warehouse::run(const std::string& sql, WarehouseError why) {
  if (is_good(ask(sql).get())) return Done{};
  return Error{why, PQerrorMessage(connection_.get())};
}

Result<int> Warehouse::schema_version() {
  const auto rows = ask("SELECT coalesce(max(version), 0) FROM calibrd_schema");
  if (!is_good(rows.get())) return Error{WarehouseError::cannot_migrate, PQerrorMessage(connection_.get())};
  return std::stoi(PQgetvalue(rows.get(), 0, 0));
}

Status Warehouse::prepare() {
  if (auto status = connect(); !status) return status;
  const auto steps = [this]() -> Status {
    constexpr auto why = WarehouseError::cannot_migrate;
    if (auto status = run(kTakeLock, why); !status) return status;
    if (auto status = run("CREATE TABLE IF NOT EXISTS calibrd_schema (version integer PRIMARY KEY, "
                          "taken_at timestamptz NOT NULL DEFAULT now())",
                          why);
        !status)
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
  const bool is_sent =
      PQsendQueryParams(connection_.get(), kInsert, 1, nullptr, values, nullptr, nullptr, 0) != 0;
  const auto rows = is_sent ? answer() : nullptr;
  if (is_good(rows.get())) return Done{};
  const auto why = !is_connected()            ? WarehouseError::no_connection
                   : is_final(rows.get())     ? WarehouseError::unfit
                   : is_of_server(rows.get()) ? WarehouseError::out_of_resources
                                              : WarehouseError::cannot_store;
  return Error{why, PQerrorMessage(connection_.get())};
}

}  // namespace calibrd::fleet
