// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "server/config/load_config.hpp"
#include "server/daemon/daemon.hpp"

namespace calibrd {

/// Reads the configuration again, applies its live keys to a running daemon and tells in the log what it did:
/// which keys were applied, which take a restart, or why all stays as it is. `now`: what is in effect.
void reload(const ConfigSources& sources, Daemon& daemon, Config& now);

}  // namespace calibrd
