// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <chrono>
#include <ctime>
#include <string>

namespace calibrd {

/// How a time is written where names are made of it ...
inline constexpr const char* kUtcCompact = "%Y%m%dT%H%M%SZ";
/// ... and, up to the seconds, in RFC 3339.
inline constexpr const char* kUtcSeconds = "%Y-%m-%dT%H:%M:%S";

/// `format` as of strftime, in UTC; at most 63 characters.
inline std::string utc_text(std::chrono::system_clock::time_point time, const char* format) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const std::time_t whole = std::chrono::system_clock::to_time_t(seconds);
  std::tm utc{};
  gmtime_r(&whole, &utc);
  std::array<char, 64> text{};
  const auto length = std::strftime(text.data(), text.size(), format, &utc);
  return {text.data(), length};
}

}  // namespace calibrd
