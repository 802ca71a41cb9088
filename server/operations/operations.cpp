// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/operations.hpp"

#include <algorithm>
#include <iterator>

#include "api/metrics/cell_metrics.hpp"
#include "api/routes/names.hpp"
#include "server/logging/logging.hpp"
#include "server/operations/process_metrics.hpp"
#include "server/operations/support_bundle.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kAuditBytes = 256 * 1024, kListedCaptures = 50;

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code none;
  const auto size = std::filesystem::file_size(file, none);
  return none ? 0 : size;
}

}  // namespace

Operations::Operations(OperationsFacts facts) : facts_(std::move(facts)), calibrations_(facts_.sensor_ids) {}

void Operations::begin(const api::CellService& cell, const api::EventHub& events, const api::Router& router) {
  cell_ = &cell;
  events_ = &events;
  router_ = &router;
  http_ = std::make_unique<api::HttpMetrics>(router);
}

void Operations::note(const api::AccessRecord& record) {
  http_->note(record.route, record.status, record.duration);
}

void Operations::look_at_disk() {
  auto log = facts_.database;
  log += "-wal";
  database_bytes_.set(static_cast<std::int64_t>(size_of(facts_.database) + size_of(log)));
}

std::string Operations::metrics() const {
  api::MetricsText text;
  write_process(text);
  write_http(text);
  api::write_cell_metrics(*cell_, text);
  calibrations_.write(text);
  text.begin("calibrd_storage_database_bytes");
  text.add({}, static_cast<double>(database_bytes_.value()));
  write_fleet(text);
  return text.take();
}

void Operations::write_process(api::MetricsText& text) const {
  text.begin("calibrd_build_info");
  text.add({{"version", facts_.version}, {"compiler", __VERSION__}}, 1);
  text.begin("calibrd_thread_heartbeat_age_seconds");
  for (const auto& [name, heartbeat] : pulse_.threads())
    if (const auto age = heartbeat->age()) text.add({{"thread", name}}, api::Seconds(*age).count());
  write_process_metrics(text);
}

void Operations::write_http(api::MetricsText& text) const {
  const auto one = [&](const char* family, auto value) {
    text.begin(family);
    text.add({}, static_cast<double>(value));
  };
  http_->write(text);
  one("calibrd_http_connections", http_watch_.connections.value());
  one("calibrd_http_connections_accepted_total", http_watch_.accepted.value());
  one("calibrd_http_connections_refused_total", http_watch_.refused.value());
  one("calibrd_http_unreadable_requests_total", http_watch_.unreadable.value());
  one("calibrd_http_unread_bytes", http_watch_.unread_bytes.value());
  one("calibrd_event_subscribers", events_->listeners());
}

/// Without a broker there is nothing to tell.
void Operations::write_fleet(api::MetricsText& text) const {
  const auto one = [&](const char* family, auto value, bool is_known = true) {
    text.begin(family);
    if (is_known && fleet_watch_.exporters.value() > 0) text.add({}, static_cast<double>(value));
  };
  const auto waiting = fleet_watch_.waiting.value();
  one("calibrd_mqtt_connected", fleet_watch_.connected.value());
  one("calibrd_mqtt_name_contested", fleet_watch_.contested.value());
  one("calibrd_mqtt_connects_total", fleet_watch_.connects.value());
  one("calibrd_mqtt_calibrations_sent_total", fleet_watch_.sent.value());
  one("calibrd_mqtt_calibrations_acknowledged_total", fleet_watch_.acknowledged.value());
  one("calibrd_mqtt_calibrations_refused_total", fleet_watch_.refused.value());
  one("calibrd_mqtt_calibrations_waiting", waiting, waiting != fleet::ExporterWatch::kNotCounted);
}

/// The answers of the interface itself, so that a bundle and a client cannot be told different things.
std::string Operations::answer_of(const std::string& path, std::map<std::string, std::string> query) const {
  return router_->answer({"GET", path, std::move(query), {}, {}}).body;
}

api::CaptureArchive Operations::support_bundle() const {
  BundleFiles files{{"version.txt", "calibrd " + facts_.version + "\n"},
                    {"config.toml", without_secrets(facts_.configuration)},
                    {"readyz.json", answer_of("/readyz", {{"verbose", ""}})},
                    {"metrics.txt", metrics()},
                    {"cell.json", answer_of("/api/v1/cell")},
                    {"cross-checks.json", answer_of("/api/v1/cell/cross-checks")},
                    {"motions.json", answer_of("/api/v1/robot/motions")}};
  for (const auto& id : facts_.sensor_ids) {
    const auto sensor = "/api/v1/sensors/" + id;
    files.emplace_back("sensors/" + id + "/pose.json", answer_of(sensor + "/pose"));
    files.emplace_back("sensors/" + id + "/drift.json", answer_of(sensor + "/drift"));
    files.emplace_back("sensors/" + id + "/calibrations.json",
                       answer_of(sensor + "/calibrations", {{"limit", "20"}}));
  }
  files.emplace_back("captures.txt", list_of_files(facts_.captures, kListedCaptures));
  files.emplace_back("log.txt", newest_log_lines());
  files.emplace_back("audit.log", end_of_file(facts_.audit_log, kAuditBytes));
  std::ranges::move(newest_captures(facts_.captures), std::back_inserter(files));
  return bundle_of(files, std::chrono::system_clock::now());
}

std::string Operations::status() const {
  std::string line = "robot " + cell_->robot().link_state;
  for (const auto& sensor : cell_->sensors())
    line += ", " + sensor.id + " " + sensor.health + ", its pose " + api::name_of(sensor.pose_state) +
            (sensor.pose_valid ? " and valid" : ", not valid");
  return line;
}

}  // namespace calibrd
