// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "server/serve_command.hpp"

namespace calibrd {

struct HealthcheckOptions {
  ServeOptions daemon;  ///< only where it gets its configuration from
  bool ready = false;   ///< asks /readyz instead of /livez
  double timeout_s = 5;
  std::string ca;
  std::string name;
  std::string certificate;
  std::string key;
};

void add_healthcheck_options(CLI::App& command, HealthcheckOptions& options);

/// Prints one line. 0: healthy. 1: not, or it cannot be told; no other status, for Docker keeps 2 for itself.
int run_healthcheck(const HealthcheckOptions& options);

}  // namespace calibrd
