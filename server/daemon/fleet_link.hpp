// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <string>

#include "api/service/cell_service.hpp"
#include "core/base/result.hpp"
#include "fleet/exporter/exporter.hpp"
#include "server/config/config.hpp"
#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// Whether what is configured of the broker can be used. Errors: ConfigError, naming the key.
Status check_mqtt(const Config& config);
/// Whether its files can be read now; a running daemon reads them at every attempt to connect.
Status check_mqtt_files(const Config& config);

/// The daemon's word to a fleet: exporter and store brought together.
class FleetLink {
 public:
  /// Leaves `made` empty where no broker is configured. Cell, store and watch must outlive it.
  static Status make(const Config& config, const std::string& version, const api::CellService& cell,
                     CalibrationStore& store, fleet::ExporterWatch& watch, std::unique_ptr<FleetLink>& made);
  ~FleetLink();

  void wake() { exporter_->wake(); }

 private:
  class StoreOutbox;
  FleetLink();
  std::unique_ptr<StoreOutbox> outbox_;
  std::unique_ptr<fleet::Exporter> exporter_;
};

/// The link, for those that call it while it comes and goes: calibrations may end until the cell does, which
/// the link must not outlive. Safe to use from any thread.
class FleetBell {
 public:
  /// See FleetLink::make().
  Status hang(const Config& config, const std::string& version, const api::CellService& cell,
              CalibrationStore& store, fleet::ExporterWatch& watch);
  /// As FleetLink::wake(); nothing happens where there is no link.
  void ring();
  /// Ends the link. ring() may still be called.
  void take_down();

 private:
  std::mutex mutex_;
  std::unique_ptr<FleetLink> link_;  // guarded by mutex_
};

}  // namespace calibrd
