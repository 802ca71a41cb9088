// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// A decoded PNG: one 16-bit value per pixel, row-major. 8-bit files keep their values (0..255); colour is
/// turned into luminance (BT.601).
struct PngImage {
  int width = 0;
  int height = 0;
  int bit_depth = 0;  ///< of the file: 8 or 16
  int channels = 0;   ///< of the file: 1 grey, 3 colour (alpha is dropped)
  std::vector<std::uint16_t> pixels;
};

/// Errors: CaptureError::unreadable, bad_png. Images beyond 64 megapixels are refused.
Result<PngImage> read_png(const std::filesystem::path& path);

/// Single-channel 16-bit PNG. pixels: width*height values. Errors: CaptureError::unwritable.
Status write_png16(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint16_t> pixels);

}  // namespace calibrd
