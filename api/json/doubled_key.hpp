// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace calibrd::api {

/// A key that stands twice in one object of a JSON text; nothing: none does. Parsers keep the last value, so
/// the first would be ignored without a word. REQUIRES: the text is valid JSON of at most the depth that
/// Boost.JSON allows by default.
std::optional<std::string> find_doubled_key(std::string_view text);

}  // namespace calibrd::api
