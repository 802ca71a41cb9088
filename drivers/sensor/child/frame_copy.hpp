// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/sensor/child/video_mode.hpp"

namespace calibrd {

/// A frame as the driver describes it. Nothing of this is true until check_frame() says so.
struct RawFrame {
  PixelFormat format = PixelFormat::other;
  int width = 0;
  int height = 0;
  int stride_bytes = 0;  ///< from one row to the next; 0: rows are packed
  bool is_cropped = false;
  std::span<const std::byte> data;
};

/// Whether `frame` is a whole frame of this size and format; otherwise SensorError::bad_frames with what
/// differs.
Status check_frame(const RawFrame& frame, PixelFormat format, int width, int height);

/// Depth as it is, grey as it is, colour as luminance (BT.601), into packed rows; `flip` reverses each row.
/// REQUIRES: check_frame() accepted the frame; `pixels` holds width*height values.
void copy_pixels(const RawFrame& frame, bool flip, std::span<std::uint16_t> pixels);

}  // namespace calibrd
