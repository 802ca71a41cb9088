// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/frame_copy.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

std::size_t stride_of(const RawFrame& frame) {
  const auto packed = static_cast<std::size_t>(frame.width) * bytes_per_pixel(frame.format);
  return frame.stride_bytes == 0 ? packed : static_cast<std::size_t>(frame.stride_bytes);
}

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

Error bad(std::string detail) { return sensor_error(SensorError::bad_frames, std::move(detail)); }

std::uint16_t luminance(std::byte red, std::byte green, std::byte blue) {
  const auto weighted = 299 * std::to_integer<unsigned>(red) + 587 * std::to_integer<unsigned>(green) +
                        114 * std::to_integer<unsigned>(blue);
  return static_cast<std::uint16_t>((weighted + 500) / 1000);
}

void copy_row(PixelFormat format, const std::byte* row, std::span<std::uint16_t> to) {
  const std::size_t count = to.size();
  switch (format) {
    case PixelFormat::grey8:
      for (std::size_t x = 0; x < count; ++x) to[x] = std::to_integer<std::uint16_t>(row[x]);
      break;
    case PixelFormat::rgb888:
      for (std::size_t x = 0; x < count; ++x) to[x] = luminance(row[3 * x], row[3 * x + 1], row[3 * x + 2]);
      break;
    case PixelFormat::yuyv:  // bytes Y U Y V
      for (std::size_t x = 0; x < count; ++x) to[x] = std::to_integer<std::uint16_t>(row[2 * x]);
      break;
    case PixelFormat::yuv422:  // bytes U Y V Y
      for (std::size_t x = 0; x < count; ++x) to[x] = std::to_integer<std::uint16_t>(row[2 * x + 1]);
      break;
    default:  // 16 bits, in this machine's byte order: the driver runs on it
      std::memcpy(to.data(), row, count * sizeof(std::uint16_t));
  }
}

}  // namespace

Status check_frame(const RawFrame& frame, PixelFormat format, int width, int height) {
  if (frame.is_cropped) return bad("a cropped frame");
  if (frame.width != width || frame.height != height)
    return bad("a frame of " + size_text(frame.width, frame.height) + " instead of " +
               size_text(width, height));
  if (frame.format != format || format == PixelFormat::other) return bad("a frame of another pixel format");
  const std::size_t row = static_cast<std::size_t>(width) * bytes_per_pixel(format);
  if (frame.stride_bytes < 0 || stride_of(frame) < row) return bad("a frame whose rows overlap");
  const std::size_t needed = stride_of(frame) * static_cast<std::size_t>(height - 1) + row;
  if (frame.data.size() < needed)
    return bad("a frame of " + std::to_string(frame.data.size()) + " bytes instead of " +
               std::to_string(needed));
  return Done{};
}

void copy_pixels(const RawFrame& frame, bool flip, std::span<std::uint16_t> pixels) {
  const auto width = static_cast<std::size_t>(frame.width);
  const std::size_t stride = stride_of(frame);
  for (std::size_t y = 0; y < static_cast<std::size_t>(frame.height); ++y) {
    const auto row = pixels.subspan(y * width, width);
    copy_row(frame.format, frame.data.data() + y * stride, row);
    if (flip) std::reverse(row.begin(), row.end());
  }
}

}  // namespace calibrd
