// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/region.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "core/paper/paper_error.hpp"

namespace calibrd {

Result<Eigen::AlignedBox3d> parse_region(std::string_view text) {
  const Error bad = fail(PaperError::bad_region, std::string(text));
  std::array<double, 6> n{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto [rest, error] = std::from_chars(at, end, n[i]);
    const bool is_last = i + 1 == n.size();
    if (error != std::errc() || !std::isfinite(n[i]) || (is_last ? rest != end : rest == end || *rest != ','))
      return bad;
    at = is_last ? rest : rest + 1;
  }
  const Eigen::Vector3d low(n[0], n[1], n[2]), high(n[3], n[4], n[5]);
  if (!(low.array() < high.array()).all()) return bad;
  return Eigen::AlignedBox3d(low, high);
}

}  // namespace calibrd
