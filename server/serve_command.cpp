// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/serve_command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "server/config/load_config.hpp"
#include "server/config/print_config.hpp"
#include "server/logging/logging.hpp"

namespace calibrd {
namespace {

constexpr const char* kDefaultFile = "/etc/calibrd/calibrd.toml";
constexpr int kUnusable = 2;

ConfigSources sources_of(const ServeOptions& options) {
  ConfigSources sources{std::nullopt, process_environment(), options.overrides};
  if (!options.config_file.empty())
    sources.file = options.config_file;
  else if (std::filesystem::exists(kDefaultFile))
    sources.file = kDefaultFile;
  return sources;
}

}  // namespace

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
  if (!loaded) {
    std::cerr << "calibrd: " << loaded.error().message() << '\n';
    return kUnusable;
  }
  if (options.print_config) {
    std::cout << config_as_toml(*loaded);
    return 0;
  }
  if (options.check_config) {
    std::cout << "the configuration is good\n";
    return 0;
  }
  start_logging(loaded->config.log);
  return 0;
}

}  // namespace calibrd
