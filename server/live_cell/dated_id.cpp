// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/dated_id.hpp"

#include <array>
#include <cstdio>
#include <ctime>

namespace calibrd {

std::string dated_id(std::chrono::system_clock::time_point time, std::mt19937& random) {
  const auto seconds = std::chrono::system_clock::to_time_t(time);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> date{};
  std::array<char, 64> id{};
  std::strftime(date.data(), date.size(), "%Y%m%dT%H%M%S", &utc);
  std::snprintf(id.data(), id.size(), "%s-%06x", date.data(), static_cast<unsigned>(random() & 0xffffffU));
  return id.data();
}

}  // namespace calibrd
