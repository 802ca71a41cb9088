// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/background_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

namespace calibrd {
namespace {

constexpr float kUnitsPerMetre = 1e4F;
constexpr std::size_t kDigits = 4;
constexpr const char* kHexadecimal = "0123456789abcdef";

}  // namespace

std::string background_text(const std::vector<float>& depth_m) {
  std::string text;
  text.reserve(kDigits * depth_m.size());
  for (const float depth : depth_m) {
    const float units = std::round(kUnitsPerMetre * depth);
    const auto value = static_cast<std::uint32_t>(units > 0 && units <= 65535.0F ? units : 0.0F);
    for (int shift = 12; shift >= 0; shift -= 4) text += kHexadecimal[(value >> shift) & 15U];
  }
  return text;
}

std::optional<std::vector<float>> parse_background(const std::string& text) {
  if (text.size() % kDigits != 0) return std::nullopt;
  std::vector<float> depth_m;
  for (std::size_t at = 0; at < text.size(); at += kDigits) {
    std::uint32_t value = 0;
    const char* end = text.data() + at + kDigits;
    const auto read = std::from_chars(text.data() + at, end, value, 16);
    if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
    depth_m.push_back(static_cast<float>(value) / kUnitsPerMetre);
  }
  return depth_m;
}

}  // namespace calibrd
