// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/serve_command.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstring>
#include <filesystem>
#include <future>
#include <iostream>

#include "server/config/config_warnings.hpp"
#include "server/config/load_config.hpp"
#include "server/config/print_config.hpp"
#include "server/daemon/checked_config.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/end_signal.hpp"
#include "server/logging/logging.hpp"
#include "server/operations/notify_socket.hpp"
#include "server/reload.hpp"
#include "server/security/run_as.hpp"

namespace calibrd {
namespace {

constexpr const char* kDefaultFile = "/etc/calibrd/calibrd.toml";
constexpr int kUnusable = 2;
constexpr auto kPatience = std::chrono::milliseconds(900);

int refuse(const Error& error) {
  std::cerr << "calibrd: " << error.message() << '\n';
  return kUnusable;
}

int only_check(const Config& config) {
  if (const auto checked = check_config(config); !checked) return refuse(checked.error());
  for (const auto& warning : config_warnings(config)) std::cerr << "calibrd: warning: " << warning << '\n';
  std::cout << "the configuration is good\n";
  return 0;
}

using Starting = std::shared_future<Result<std::shared_ptr<Daemon>>>;

/// Waits for the end; on the way there, reads the configuration again whenever that is asked for.
int wait_for_end(const EndSignal& signals, const Starting& starting, const ConfigSources& sources,
                 const std::optional<NotifySocket>& socket, Config now) {
  for (;;) {
    const int number = signals.wait();
    if (number != SIGHUP) return number;
    if (starting.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      spdlog::warn("SIGHUP: the daemon is still starting; send it again when it listens");
    else if (starting.get()) {
      if (socket) socket->send(reloading_lines());
      reload(sources, **starting.get(), now);
      if (socket) socket->send("READY=1");
    }
  }
}

/// What takes rights that are given up for good then.
Result<api::Entrance> enter(const ServerConfig& server, const Config& config) {
  auto entrance = Daemon::open(config);
  if (!entrance || server.run_as.empty()) return entrance;
  if (auto status = become(server.run_as); !status) return status.error();
  return entrance;
}

/// Starts in a thread of its own, so that the signal is heard while a large robot model is being read.
int serve(const LoadedConfig& loaded, const ConfigSources& sources) {
  const Config& config = loaded.config;
  const auto orders = take_notify_orders();
  const auto socket = NotifySocket::open(orders.address);
  const ServiceManager manager{socket ? &*socket : nullptr, orders.watchdog};
  const EndSignal signals;
  const auto entrance = enter(config.server, config);
  if (!entrance) return refuse(entrance.error());
  const auto start = [&, main = pthread_self()]() -> Result<std::shared_ptr<Daemon>> {
    auto daemon = Daemon::start(config, *entrance, CALIBRD_VERSION, config_as_toml(loaded), manager);
    if (!daemon) {
      pthread_kill(main, SIGTERM);
      return daemon.error();
    }
    spdlog::info("calibrd {} listens on {}:{}", CALIBRD_VERSION, config.server.address,
                 (*daemon)->http_port());
    return std::shared_ptr<Daemon>(*std::move(daemon));
  };
  const Starting starting = std::async(std::launch::async, start).share();
  const int number = wait_for_end(signals, starting, sources, socket, config);
  if (socket) socket->send("STOPPING=1");
  EndSignal::end_within(kPatience);
  const auto& daemon = starting.get();
  if (!daemon) return refuse(daemon.error());
  spdlog::info("ending on {}", strsignal(number));
  (*daemon)->stop();
  return 0;
}

}  // namespace

ConfigSources sources_of(const ServeOptions& options) {
  ConfigSources sources{std::nullopt, process_environment(), options.overrides};
  if (!options.config_file.empty())
    sources.file = options.config_file;
  else if (std::filesystem::exists(kDefaultFile))
    sources.file = kDefaultFile;
  return sources;
}

void add_serve_options(CLI::App& command, ServeOptions& options) {
  command.add_option("--config", options.config_file, "Configuration file (TOML)")->type_name("FILE");
  command.add_option("--set", options.overrides, "Set one key of the configuration")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  command.add_flag("--check-config", options.check_config, "Check the configuration and end");
  command.add_flag("--print-config", options.print_config, "Print the configuration in effect and end");
}

int run_serve(const ServeOptions& options) {
  const auto sources = sources_of(options);
  const auto loaded = load_config(sources);
  if (!loaded) return refuse(loaded.error());
  if (options.print_config) {
    std::cout << config_as_toml(*loaded);
    return 0;
  }
  start_logging(loaded->config.log);
  return options.check_config ? only_check(loaded->config) : serve(*loaded, sources);
}

}  // namespace calibrd
