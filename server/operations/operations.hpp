// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "api/events/event_hub.hpp"
#include "api/http/http_server.hpp"
#include "api/metrics/calibration_metrics.hpp"
#include "api/metrics/http_metrics.hpp"
#include "api/service/cell_service.hpp"
#include "api/service/operations_service.hpp"
#include "fleet/exporter/exporter_watch.hpp"
#include "server/operations/pulse.hpp"

namespace calibrd {

struct OperationsFacts {
  std::string version;
  std::string configuration;  ///< in effect, as TOML
  std::filesystem::path database;
  std::filesystem::path captures;   ///< folder of the views of calibrations
  std::filesystem::path audit_log;  ///< the file need not exist
  std::vector<std::string> sensor_ids;
};

/// What the daemon counts, and what it tells of itself. begin() once all it refers to is there, before
/// anybody asks; the rest is safe to call from any thread.
class Operations : public api::OperationsService {
 public:
  explicit Operations(OperationsFacts facts);

  /// All must outlive the last question.
  void begin(const api::CellService& cell, const api::EventHub& events, const api::Router& router);

  void note(const api::AccessRecord& record);
  void note(const api::CalibrationReport& calibration) { calibrations_.note(calibration); }
  /// Waits for the disk; to be called every few seconds.
  void look_at_disk();

  api::HttpWatch& http_watch() { return http_watch_; }
  fleet::ExporterWatch& fleet_watch() { return fleet_watch_; }
  /// The threads that must go on; to be filled before begin().
  Pulse& pulse() { return pulse_; }

  std::string metrics() const override;
  std::vector<std::string> stalled_threads() const override { return pulse_.stalled(); }
  api::CaptureArchive support_bundle() const override;

  /// One line: how the robot and every sensor are. Quick.
  std::string status() const;

 private:
  void write_process(api::MetricsText& text) const;
  void write_http(api::MetricsText& text) const;
  void write_fleet(api::MetricsText& text) const;
  std::string answer_of(const std::string& path, std::map<std::string, std::string> query = {}) const;

  const OperationsFacts facts_;
  api::CalibrationMetrics calibrations_;
  api::HttpWatch http_watch_;
  fleet::ExporterWatch fleet_watch_;
  api::Gauge database_bytes_;
  Pulse pulse_;
  std::unique_ptr<api::HttpMetrics> http_;
  const api::CellService* cell_ = nullptr;
  const api::EventHub* events_ = nullptr;
  const api::Router* router_ = nullptr;
};

}  // namespace calibrd
