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
#include "server/daemon/daemon.hpp"
#include "server/daemon/end_signal.hpp"
#include "server/logging/logging.hpp"
#include "server/operations/notify_socket.hpp"

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

/// Starts in a thread of its own, so that the signal is heard while a large robot model is being read.
int serve(const LoadedConfig& loaded) {
  const Config& config = loaded.config;
  const auto orders = take_notify_orders();
  const auto socket = NotifySocket::open(orders.address);
  const ServiceManager manager{socket ? &*socket : nullptr, orders.watchdog};
  const EndSignal end;
  auto starting = std::async(std::launch::async, [&, main = pthread_self()] {
    auto daemon = Daemon::start(config, CALIBRD_VERSION, config_as_toml(loaded), manager);
    if (daemon)
      spdlog::info("calibrd {} listens on {}:{}", CALIBRD_VERSION, config.server.address,
                   (*daemon)->http_port());
    else
      pthread_kill(main, SIGTERM);
    return daemon;
  });
  const int number = end.wait();
  if (socket) socket->send("STOPPING=1");
  EndSignal::end_within(kPatience);
  const auto daemon = starting.get();
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
  const auto loaded = load_config(sources_of(options));
  if (!loaded) return refuse(loaded.error());
  if (options.print_config) {
    std::cout << config_as_toml(*loaded);
    return 0;
  }
  start_logging(loaded->config.log);
  return options.check_config ? only_check(loaded->config) : serve(*loaded);
}

}  // namespace calibrd
