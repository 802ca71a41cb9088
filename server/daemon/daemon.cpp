// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.hpp"

#include <spdlog/spdlog.h>

#include "api/http/http_server.hpp"
#include "api/routes/routes.hpp"
#include "drivers/sensor/sensor_process.hpp"
#include "server/daemon/checked_config.hpp"
#include "server/daemon/conversions.hpp"
#include "server/daemon/descriptor_limit.hpp"
#include "server/daemon/event_log.hpp"
#include "server/daemon/feed_thread.hpp"
#include "server/daemon/fleet_link.hpp"
#include "server/daemon/motion_link.hpp"
#include "server/daemon/robot_link.hpp"
#include "server/live_cell/live_cell.hpp"
#include "server/operations/operations.hpp"
#include "server/operations/service_watch.hpp"
#include "server/security/audit_log.hpp"
#include "server/security/exposure.hpp"
#include "server/security/token_store.hpp"
#include "server/storage/calibration_store.hpp"
#include "server/storage/store_watch.hpp"

namespace calibrd {
namespace {

constexpr auto kHttpGrace = std::chrono::milliseconds(200);

AuditSettings audit_settings(const Config& config) {
  return {config.storage.path.parent_path() / "audit.jsonl",
          static_cast<std::uint64_t>(config.audit.max_file_mb) * 1'000'000, config.audit.files};
}

/// Where the page lies: beside the program's folder, in a build as when installed.
std::filesystem::path page_folder() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return program.parent_path().parent_path() / "share/calibrd/web";
}

}  // namespace

/// In the order they are made; they end in the opposite one.
struct Daemon::Parts {
  std::unique_ptr<Operations> operations;
  std::unique_ptr<CalibrationStore> store;
  std::shared_ptr<CaptureFolder> captures;
  std::unique_ptr<StoreWatch> store_watch;
  std::unique_ptr<const RobotModel> model;
  std::unique_ptr<const VirtualCell> virtual_cell;
  std::unique_ptr<MotionLink> motion;  // only where the robot may be moved
  std::unique_ptr<AuditLog> audit;     // outlives all that changes something
  FleetBell fleet;                     // outlives the cell, which rings it; its link does not
  std::unique_ptr<LiveCell> cell;
  std::unique_ptr<RobotLink> link;
  std::unique_ptr<FeedThread> feed;
  api::Router router;
  std::shared_ptr<api::Authenticator> authenticator;  // only where tokens are asked for
  std::unique_ptr<api::HttpServer> http;
  std::unique_ptr<ServiceWatch> service_watch;

  void make_operations(const Config& config, const std::string& version, const std::string& configuration) {
    OperationsFacts facts{version,
                          configuration,
                          config.storage.path,
                          capture_folder_of(config.storage.path),
                          audit_settings(config).file,
                          {}};
    for (const auto& [id, sensor] : config.sensors) facts.sensor_ids.push_back(id);
    operations = std::make_unique<Operations>(std::move(facts));
  }

  Status open_store(const Config& config) {
    auto opened = CalibrationStore::open(config.storage.path);
    if (!opened) return opened.error();
    store = *std::move(opened);
    captures = std::make_shared<CaptureFolder>(
        capture_folder_of(config.storage.path),
        CaptureLimits{config.storage.captures_max_age,
                      static_cast<std::uint64_t>(config.storage.captures_max_mb) * 1'000'000});
    audit = std::make_unique<AuditLog>(audit_settings(config), log_error);
    store_watch = std::make_unique<StoreWatch>(*store, log_storage, [this] {
      captures->remove_old();
      operations->look_at_disk();
    });
    return Done{};
  }

  Status make_model(const Config& config) {
    auto loaded = load_model(config.robot);
    if (!loaded) return loaded.error();
    model = std::make_unique<const RobotModel>(*std::move(loaded));
    virtual_cell = std::make_unique<const VirtualCell>(*model);
    return Done{};
  }

  Status make_cell(const Config& config, const std::string& version, const std::string& configuration) {
    auto mapping = make_mapping(config, *model);
    if (!mapping) return mapping.error();
    if (auto status = check_motion(config, *model, *mapping); !status) return status;
    auto frame = controller_frame(*model, config.robot);
    if (!frame) return frame.error();
    auto settings = cell_settings(config, version);
    settings.controller_frame = *std::move(frame);
    settings.configuration = configuration;
    settings.captures = captures;
    cell =
        std::make_unique<LiveCell>(std::move(settings), *model, *virtual_cell, *std::move(mapping), *store,
                                   core_estimator(*virtual_cell, drift_settings(config.drift)), cell_log());
    for (const auto& [id, sensor] : config.sensors)
      if (auto status = cell->add_sensor(sensor_setup(id, sensor)); !status) return status;
    return Done{};
  }

  CellLog cell_log() {
    const auto on_calibration = [this](const api::CalibrationReport& calibration) {
      operations->note(calibration);
      log_calibration(calibration);
      if (calibration.current)
        audit->note({"calibrd",
                     "pose of " + calibration.sensor_id,
                     true,
                     "/api/v1/calibrations/" + calibration.id,
                     {}});
      fleet.ring();
    };
    return {on_calibration, log_pose, log_error, log_motion, log_calibration_start};
  }

  Status make_link(const Config& config) {
    auto events = logged_link(cell->robot_link().events());
    if (config.motion.enabled) {
      motion = std::make_unique<MotionLink>(motion_client_settings(config));
      cell->robot_motions().set_mover(&motion->mover());
      events = motion->heard(std::move(events));
      spdlog::warn("motion.enabled: this daemon moves the robot when it is asked to");
    }
    auto created = RobotLink::create(link_settings(config.robot), std::move(events));
    if (!created) return created.error();
    link = *std::move(created);
    cell->robot_link().set_health_source([this] { return link->health(); });
    return Done{};
  }

  /// Who may come in, and who is told of what they do.
  Status make_doors(const Config& config, api::HttpServerSettings& settings) {
    if (!config.server.tokens_file.empty()) {
      const auto on_change = [this](const std::string& what, bool is_done) {
        audit->note({"tokens file", "tokens", is_done, {}, what});
      };
      auto tokens = TokenStore::open(config.server.tokens_file, log_security, on_change);
      if (!tokens) return tokens.error();
      authenticator = *std::move(tokens);
      settings.door.authenticator = authenticator;
    } else if (!is_loopback(config.server.address) && config.server.tls.client_ca.empty()) {
      log_security(
          "server.allow_unauthenticated: whoever reaches " + config.server.address + " may do everything",
          false);
    }
    settings.audit = [this](const api::AuditRecord& record) { audit->write(record); };
    return Done{};
  }

  Status make_http(const Config& config, api::Entrance entrance) {
    auto settings = http_settings(config);
    settings.max_connections = room_for_connections(settings.max_connections);
    settings.entrance = std::move(entrance);
    if (auto status = make_doors(config, settings); !status) return status;
    feed = std::make_unique<FeedThread>(*cell);
    router = api::make_routes(*cell, feed->hub(), *operations, api::PageFiles::read(page_folder()));
    auto& pulse = operations->pulse();
    pulse.add("http", operations->http_watch().network_thread);
    pulse.add("robot link", link->heartbeat());
    for (const auto& [id, heartbeat] : cell->heartbeats()) pulse.add("sensor " + id, *heartbeat);
    operations->begin(*cell, feed->hub(), router);
    const auto on_answer = [this](const api::AccessRecord& record) {
      operations->note(record);
      log_access(record);
    };
    auto server = api::HttpServer::start(settings, router, on_answer, &operations->http_watch());
    if (!server) return server.error();
    http = *std::move(server);
    return Done{};
  }

  Status start_sources(const Config& config) {
    link->start();
    for (const auto& [id, sensor] : config.sensors) {
      auto source = SensorProcess::start(sensor_settings(id, sensor));
      if (!source) return source.error();
      cell->start(id, std::make_unique<LoggedSource>(id, *std::move(source)));
    }
    return Done{};
  }

  void watch_service(const ServiceManager& manager) {
    ServiceView view;
    view.status = [this] { return operations->status(); };
    view.stalled = [this](std::chrono::nanoseconds limit) { return operations->pulse().stalled(limit); };
    view.on_stall = log_stall;
    if (manager.socket) manager.socket->send("READY=1");
    service_watch = std::make_unique<ServiceWatch>(manager.socket, manager.watchdog, std::move(view));
  }
};

Result<std::unique_ptr<Daemon>> Daemon::start(const Config& config, api::Entrance entrance,
                                              const std::string& version, const std::string& configuration,
                                              const ServiceManager& manager) {
  std::unique_ptr<Daemon> daemon(new Daemon(std::make_unique<Parts>()));
  auto& parts = *daemon->parts_;
  if (auto status = check_sensors(config); !status) return status.error();
  parts.make_operations(config, version, configuration);
  if (auto status = parts.make_model(config); !status) return status.error();
  if (auto status = parts.open_store(config); !status) return status.error();
  if (auto status = parts.make_cell(config, version, configuration); !status) return status.error();
  if (auto status = parts.make_link(config); !status) return status.error();
  auto& fleet_watch = parts.operations->fleet_watch();
  if (auto status = parts.fleet.hang(config, version, *parts.cell, *parts.store, fleet_watch); !status)
    return status.error();
  if (auto status = parts.make_http(config, std::move(entrance)); !status) return status.error();
  if (auto status = parts.start_sources(config); !status) return status.error();
  parts.watch_service(manager);
  return daemon;
}

Daemon::Daemon(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Daemon::~Daemon() { stop(); }

void Daemon::stop() {
  parts_->service_watch.reset();
  if (parts_->cell) parts_->cell->request_stop();
  if (parts_->motion) parts_->motion->stop();
  if (parts_->http) parts_->http->stop(kHttpGrace);
  if (parts_->link) parts_->link->stop();
  parts_->http.reset();
  parts_->feed.reset();
  parts_->fleet.take_down();
  parts_->cell.reset();
}

Result<api::Entrance> Daemon::open(const Config& config) {
  if (auto status = check_exposure(config.server); !status) return status.error();
  return api::HttpServer::open(http_settings(config));
}

Status Daemon::apply(const Config& config) {
  if (auto status = check_exposure(config.server); !status) return status;
  auto settings = http_settings(config);
  settings.max_connections = room_for_connections(settings.max_connections);
  settings.door.authenticator = parts_->authenticator;
  return parts_->http->apply(settings);
}

void Daemon::note_reload(bool is_done, const std::string& detail) {
  parts_->audit->note({"SIGHUP", "configuration", is_done, {}, detail});
}

std::uint16_t Daemon::http_port() const { return parts_->http->port(); }

}  // namespace calibrd
