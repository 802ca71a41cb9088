// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace calibrd {
namespace {

/// Levenshtein distance.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view wanted, std::span<const std::string> known) {
  std::string nearest;
  std::size_t fewest = wanted.size() / 2 + 1;
  for (const auto& name : known)
    if (const auto count = edits(wanted, name); count < fewest) {
      fewest = count;
      nearest = name;
    }
  return nearest;
}

std::string name_hint(std::string_view wanted, std::span<const std::string> known) {
  std::string hint;
  if (const auto nearest = nearest_name(wanted, known); !nearest.empty())
    hint = "did you mean '" + nearest + "'? ";
  hint += "known:";
  for (std::size_t i = 0; i < known.size(); ++i) hint += (i == 0 ? " " : ", ") + known[i];
  return hint;
}

}  // namespace calibrd
