// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.hpp"
#include "server/config/config.hpp"

namespace calibrd {

/// Only this machine reaches the address.
bool is_loopback(const std::string& address);

/// Refuses a server that others than this machine reach and that asks for no token, unless that is wanted.
/// Error: SecurityError::open_without_tokens, naming the address.
Status check_exposure(const ServerConfig& server);

}  // namespace calibrd
