// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

namespace calibrd::api {

/// What a client may do; each includes those before it. `open` needs no token.
enum class Scope { open, read, calibrate, admin };

/// "read", "calibrate", "admin"; "open".
const char* name_of(Scope scope);

/// The scope a token can have by its name; nothing for any other text.
std::optional<Scope> scope_named(std::string_view name);

}  // namespace calibrd::api
