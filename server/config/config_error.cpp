// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_error.hpp"

#include <string>

namespace calibrd {
namespace {

const char* text(ConfigError code) {
  switch (code) {
    case ConfigError::file_unreadable:
      return "the configuration file cannot be read; check the path given with --config and its permissions";
    case ConfigError::not_toml:
      return "not valid TOML; correct the line that is named";
    case ConfigError::unknown_key:
      return "no such key; correct its name or remove it (docs/configuration.md lists every key)";
    case ConfigError::bad_value:
      return "the value cannot be used; correct it (docs/configuration.md gives type and range)";
    case ConfigError::missing_key:
      return "this key is needed and has no default; add it to the configuration";
    case ConfigError::bad_override:
      return "write overrides as --set section.key=value, for example --set server.port=8081";
  }
  return "unknown configuration error";
}

class ConfigCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "config"; }
  std::string message(int code) const override { return text(static_cast<ConfigError>(code)); }
};

}  // namespace

const std::error_category& config_category() {
  static const ConfigCategory category;
  return category;
}

std::error_code make_error_code(ConfigError code) { return {static_cast<int>(code), config_category()}; }

}  // namespace calibrd
