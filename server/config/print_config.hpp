// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "server/config/load_config.hpp"

namespace calibrd {

/// The configuration in effect as TOML that can be read back, each value that is not a default with its
/// origin.
std::string config_as_toml(const LoadedConfig& loaded);

/// docs/configuration.md.
std::string config_reference();

}  // namespace calibrd
