// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "server/config/config.hpp"

namespace calibrd {

/// Where a configuration comes from; what stands further down wins.
struct ConfigSources {
  std::optional<std::filesystem::path> file;
  std::vector<std::string> environment;  ///< "NAME=value"; only CALIBRD_SECTION__KEY is looked at
  std::vector<std::string> overrides;    ///< "section.key=value", from --set
};

struct LoadedConfig {
  Config config;
  std::map<std::string, std::string> origins;  ///< "server.port" -> "calibrd.toml:3"; defaults are absent
};

/// Reads, layers and checks the configuration. It does not look at what paths point to.
/// Errors: ConfigError, the detail naming file and line (or variable, or option) and the key.
Result<LoadedConfig> load_config(const ConfigSources& sources);

/// The environment of this process as "NAME=value".
std::vector<std::string> process_environment();

}  // namespace calibrd
