// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "api/service/cell_service.hpp"
#include "core/base/result.hpp"
#include "fleet/exporter/exporter.hpp"
#include "server/config/config.hpp"
#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// Whether what is configured of the broker can be used. Errors: ConfigError, naming the key.
Status check_mqtt(const Config& config);

/// The daemon's word to a fleet: exporter and store brought together.
class FleetLink {
 public:
  /// Leaves `made` empty where no broker is configured. Cell and store must outlive it.
  static Status make(const Config& config, const std::string& version, const api::CellService& cell,
                     CalibrationStore& store, std::unique_ptr<FleetLink>& made);
  ~FleetLink();

  void wake() { exporter_->wake(); }

 private:
  class StoreOutbox;
  FleetLink();
  std::unique_ptr<StoreOutbox> outbox_;
  std::unique_ptr<fleet::Exporter> exporter_;
};

}  // namespace calibrd
