// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why a configuration cannot be used. Error::detail names where (file:line, environment variable or --set)
/// and which key.
enum class ConfigError {
  file_unreadable = 1,
  not_toml,
  unknown_key,
  bad_value,
  missing_key,
  bad_override,
};

const std::error_category& config_category();
std::error_code make_error_code(ConfigError code);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::ConfigError> : std::true_type {};
