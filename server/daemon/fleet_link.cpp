// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/fleet_link.hpp"

#include "fleet/messages/topics.hpp"
#include "server/config/config_error.hpp"
#include "server/daemon/event_log.hpp"

namespace calibrd {
namespace {

constexpr int kPlainPort = 1883, kTlsPort = 8883;

fleet::ExporterSettings settings_of(const MqttConfig& mqtt, const std::string& version) {
  fleet::ExporterSettings settings;
  settings.prefix = mqtt.prefix;
  settings.cell = mqtt.cell;
  settings.version = version;
  auto& broker = settings.broker;
  broker.host = mqtt.host;
  broker.port = mqtt.port != 0 ? mqtt.port : mqtt.tls.enabled ? kTlsPort : kPlainPort;
  broker.username = mqtt.username;
  broker.password_file = mqtt.password_file;
  broker.tls = mqtt.tls.enabled;
  broker.ca = mqtt.tls.ca;
  broker.certificate = mqtt.tls.certificate;
  broker.key = mqtt.tls.key;
  return settings;
}

Error bad(const std::string& what) { return {ConfigError::bad_value, what}; }

}  // namespace

class FleetLink::StoreOutbox final : public fleet::Outbox {
 public:
  explicit StoreOutbox(CalibrationStore& store) : store_(store) {}

  std::uint64_t generation() const override { return store_.outbox_generation(); }

  Result<std::vector<fleet::OutboxRow>> waiting(std::int64_t after, int limit) override {
    auto entries = store_.outbox(after, limit);
    if (!entries) return entries.error();
    std::vector<fleet::OutboxRow> rows;
    for (auto& entry : *entries) rows.push_back({entry.number, std::move(entry.calibration)});
    return rows;
  }

  Result<std::int64_t> size() override { return store_.outbox_size(); }

  Status remove(const std::vector<std::string>& calibration_ids) override {
    return store_.remove_from_outbox(calibration_ids);
  }

 private:
  CalibrationStore& store_;
};

Status check_mqtt(const Config& config) {
  const auto& mqtt = config.mqtt;
  if (mqtt.host.empty()) return Done{};
  if (!fleet::is_name(mqtt.cell))
    return bad(
        "mqtt.cell: with mqtt.host the cell needs a name of letters, digits, '.', '_' and '-', at most 64");
  if (!fleet::is_name(mqtt.prefix)) return bad("mqtt.prefix: letters, digits, '.', '_' and '-', at most 64");
  if (mqtt.tls.certificate.empty() != mqtt.tls.key.empty())
    return bad("mqtt.tls: certificate and key come together");
  if (!mqtt.tls.enabled && !(mqtt.tls.ca.empty() && mqtt.tls.certificate.empty()))
    return bad(
        "mqtt.tls: its files are of no use without mqtt.tls.enabled = true: the password would go in clear");
  if (mqtt.username.empty() && !mqtt.password_file.empty())
    return bad("mqtt.password_file: a password is sent with mqtt.username alone; set that, too");
  for (const auto& [id, sensor] : config.sensors)
    if (!fleet::is_name(id))
      return bad("sensors." + id +
                 ": its name is a part of topics: letters, digits, '.', '_' and '-', at most 64");
  return Done{};
}

Status check_mqtt_files(const Config& config) {
  if (config.mqtt.host.empty()) return Done{};
  if (auto status = fleet::MqttClient::check(settings_of(config.mqtt, {}).broker); !status)
    return Error{status.error().code, "mqtt: " + status.error().detail};
  return Done{};
}

FleetLink::FleetLink() = default;
FleetLink::~FleetLink() = default;

Status FleetLink::make(const Config& config, const std::string& version, const api::CellService& cell,
                       CalibrationStore& store, fleet::ExporterWatch& watch,
                       std::unique_ptr<FleetLink>& made) {
  if (config.mqtt.host.empty()) return Done{};
  if (auto status = check_mqtt(config); !status) return status;
  std::unique_ptr<FleetLink> link(new FleetLink);
  link->outbox_ = std::make_unique<StoreOutbox>(store);
  auto exporter =
      fleet::Exporter::start(settings_of(config.mqtt, version), cell, *link->outbox_, log_security, watch);
  if (!exporter) return Error{exporter.error().code, "mqtt: " + exporter.error().detail};
  link->exporter_ = *std::move(exporter);
  made = std::move(link);
  return Done{};
}

Status FleetBell::hang(const Config& config, const std::string& version, const api::CellService& cell,
                       CalibrationStore& store, fleet::ExporterWatch& watch) {
  std::unique_ptr<FleetLink> made;
  if (auto status = FleetLink::make(config, version, cell, store, watch, made); !status) return status;
  const std::lock_guard lock(mutex_);
  link_ = std::move(made);
  return Done{};
}

void FleetBell::ring() {
  const std::lock_guard lock(mutex_);
  if (link_) link_->wake();
}

void FleetBell::take_down() {
  std::unique_ptr<FleetLink> link;
  {
    const std::lock_guard lock(mutex_);
    link.swap(link_);
  }
  link.reset();  // which takes a moment: the broker is told
}

}  // namespace calibrd
