// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "server/config/config.hpp"

namespace calibrd {

/// What differs between two configurations, by the names of the keys.
struct ConfigChanges {
  std::vector<std::string> live;     ///< can be applied to a running daemon
  std::vector<std::string> restart;  ///< take a restart
};

ConfigChanges changes_between(const Config& old, const Config& fresh);

/// `old` with the live keys of `fresh`.
Config with_live_keys(const Config& old, const Config& fresh);

}  // namespace calibrd
