// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace calibrd {

/// The text as a basic string of TOML, in double quotes, on one line.
std::string quoted(const std::string& text);

}  // namespace calibrd
