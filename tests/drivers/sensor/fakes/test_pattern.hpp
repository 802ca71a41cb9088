// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace calibrd::fake {

inline constexpr int kWidth = 64, kHeight = 48;
inline constexpr int kFps = 100;

/// Pixels of frame `index`: every pixel follows from the index, so a frame mixed of two is recognised. Depth
/// stays below 32768, where recordings are exact. The first pixel is the index itself, the second the
/// device's number.
inline std::uint16_t depth_at(int index, int device, int x, int y) {
  if (y == 0 && x == 0) return static_cast<std::uint16_t>(index % 32768);
  if (y == 0 && x == 1) return static_cast<std::uint16_t>(1000 + device);
  return static_cast<std::uint16_t>(500 + (index * 131 + y * 67 + x * 3) % 7000);
}

inline std::uint16_t infrared_at(int index, int x, int y) {
  return static_cast<std::uint16_t>((index * 257 + y * 91 + x) % 65536);
}

/// The same value in red, green and blue: so grey that it equals its luminance.
inline std::uint8_t color_at(int index, int x, int y) {
  return static_cast<std::uint8_t>((index + x + y) % 256);
}

}  // namespace calibrd::fake
