// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace calibrd {

/// Height of a table in the base frame, m, as a person gives it: a number within 10 m of the base. Nothing:
/// it is none.
std::optional<double> parse_table_height(std::string_view text);

/// What to say of a text that is none.
std::string not_a_table_height(std::string_view text);

}  // namespace calibrd
