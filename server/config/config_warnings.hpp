// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "server/config/config.hpp"

namespace calibrd {

/// What can be used and is hardly meant, in words: intrinsics of a sensor that nobody has measured.
std::vector<std::string> config_warnings(const Config& config);

}  // namespace calibrd
