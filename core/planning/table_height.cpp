// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/table_height.hpp"

#include <charconv>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kFarthestTable_m = 10;

}  // namespace

std::optional<double> parse_table_height(std::string_view text) {
  const auto* end = text.data() + text.size();
  double height_m = 0;
  const auto [rest, failure] = std::from_chars(text.data(), end, height_m);
  const bool is_number = failure == std::errc() && rest == end;
  if (!is_number || !(std::abs(height_m) <= kFarthestTable_m)) return std::nullopt;  // so that NaN fails too
  return height_m;
}

std::string not_a_table_height(std::string_view text) {
  return "\"" + std::string(text) + "\" is not a height within 10 m";
}

}  // namespace calibrd
