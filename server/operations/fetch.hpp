// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// GET of a daemon on this machine: the body of a 200. `address`: as configured; that of any interface stands
/// for this machine. Error: why there is none, in words, with code std::errc. Waits at most half a minute for
/// each part.
Result<std::string> fetch(const std::string& address, std::uint16_t port, const std::string& path,
                          const std::string& token = {});

}  // namespace calibrd
