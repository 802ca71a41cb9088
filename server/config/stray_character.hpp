// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace calibrd {

/// The line (from 1) of the first character that is not ASCII where TOML allows none: outside comments and
/// quotes. Text in triple double quotes counts as outside. To be asked before toml++ parses: versions up to
/// 3.4 take such a character for one that cannot be (undefined behaviour in
/// is_non_ascii_horizontal_whitespace).
std::optional<std::size_t> line_of_stray_character(std::string_view toml);

}  // namespace calibrd
