// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace calibrd {

/// Pixel formats calibrd understands, as OpenNI2 names them.
enum class PixelFormat { depth_1_mm, depth_100_um, grey8, grey16, rgb888, yuv422, yuyv, other };

/// Size of one pixel; 0 for `other`.
std::size_t bytes_per_pixel(PixelFormat format);

struct VideoMode {
  PixelFormat format = PixelFormat::other;
  int width = 0;
  int height = 0;
  int fps = 0;
  bool operator==(const VideoMode&) const = default;
};

/// The offered mode of this size and rate (0 = any, the highest wins), of the first format in `formats` that
/// is offered at all.
std::optional<VideoMode> choose_mode(std::span<const VideoMode> offers, int width, int height, int fps,
                                     std::span<const PixelFormat> formats);

/// "640x480 at 30 (depth 1 mm), …" for messages.
std::string describe(std::span<const VideoMode> modes);

}  // namespace calibrd
