// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/dated_id.hpp"

#include <array>
#include <cstdio>

#include "core/base/utc_text.hpp"

namespace calibrd {

std::string dated_id(std::chrono::system_clock::time_point time, std::mt19937& random) {
  std::array<char, 64> id{};
  const auto date = utc_text(time, "%Y%m%dT%H%M%S");
  std::snprintf(id.data(), id.size(), "%s-%06x", date.c_str(), static_cast<unsigned>(random() & 0xffffffU));
  return id.data();
}

}  // namespace calibrd
