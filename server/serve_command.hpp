// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "server/config/load_config.hpp"

namespace CLI {
class App;
}

namespace calibrd {

struct ServeOptions {
  std::string config_file;  ///< empty: /etc/calibrd/calibrd.toml where it exists
  std::vector<std::string> overrides;
  bool check_config = false;
  bool print_config = false;
};

/// Where its configuration comes from.
ConfigSources sources_of(const ServeOptions& options);

void add_serve_options(CLI::App& command, ServeOptions& options);

/// Runs the daemon until SIGTERM or SIGINT. Exit status: 0 ended as asked, 2 the configuration or something
/// it names cannot be used (the reason is on stderr), 1 failed while running.
int run_serve(const ServeOptions& options);

}  // namespace calibrd
