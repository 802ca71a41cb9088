// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/base/result.hpp"
#include "core/geometry/camera_model.hpp"

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

/// Given a camera, the image must be of its size; that is checked before anything is unpacked.
/// Errors: CaptureError::unreadable, file_too_large, bad_png (also beyond 8192 pixels a side),
/// wrong_image_size.
Result<PngImage> read_png(const std::filesystem::path& path, const CameraModel* camera = nullptr);

/// Single-channel 16-bit PNG. pixels: width*height values. Errors: CaptureError::unwritable (also when the
/// number of pixels is another).
Status write_png16(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint16_t> pixels);

}  // namespace calibrd
