// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/video_mode.hpp"

namespace calibrd {
namespace {

const char* name(PixelFormat format) {
  switch (format) {
    case PixelFormat::depth_1_mm:
      return "depth 1 mm";
    case PixelFormat::depth_100_um:
      return "depth 100 um";
    case PixelFormat::grey8:
      return "grey 8 bit";
    case PixelFormat::grey16:
      return "grey 16 bit";
    case PixelFormat::rgb888:
      return "RGB";
    case PixelFormat::yuv422:
      return "YUV 4:2:2";
    case PixelFormat::yuyv:
      return "YUYV";
    case PixelFormat::other:
      break;
  }
  return "other format";
}

}  // namespace

std::size_t bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::grey8:
      return 1;
    case PixelFormat::rgb888:
      return 3;
    case PixelFormat::other:
      return 0;
    default:
      return 2;
  }
}

std::optional<VideoMode> choose_mode(std::span<const VideoMode> offers, int width, int height, int fps,
                                     std::span<const PixelFormat> formats) {
  for (const PixelFormat format : formats) {
    std::optional<VideoMode> best;
    for (const VideoMode& offer : offers) {
      const bool fits = offer.format == format && offer.width == width && offer.height == height;
      if (!fits || (fps != 0 && offer.fps != fps)) continue;
      if (!best || offer.fps > best->fps) best = offer;
    }
    if (best) return best;
  }
  return std::nullopt;
}

std::string describe(std::span<const VideoMode> modes) {
  std::string text;
  for (const VideoMode& mode : modes) {
    if (!text.empty()) text += ", ";
    text += std::to_string(mode.width) + "x" + std::to_string(mode.height) + " at " +
            std::to_string(mode.fps) + " (" + name(mode.format) + ")";
  }
  return text.empty() ? "none" : text;
}

}  // namespace calibrd
