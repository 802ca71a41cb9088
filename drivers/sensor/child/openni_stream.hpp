// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <OpenNI.h>

#include <memory>

#include "core/base/result.hpp"
#include "drivers/sensor/child/frame_copy.hpp"
#include "drivers/sensor/child/frame_numbering.hpp"
#include "drivers/sensor/child/openni_device.hpp"
#include "drivers/sensor/child/video_mode.hpp"

namespace calibrd {

VideoMode to_video_mode(const openni::VideoMode& mode);

/// One stream of a device, set to one mode, uncropped, unmirrored.
class OpenNiStream {
 public:
  /// The device must outlive the stream.
  static Result<std::unique_ptr<OpenNiStream>> create(OpenNiDevice& device, openni::SensorType sensor,
                                                      const VideoMode& mode, bool mirror);
  ~OpenNiStream();
  OpenNiStream(const OpenNiStream&) = delete;
  OpenNiStream& operator=(const OpenNiStream&) = delete;

  Status start();
  openni::VideoStream& handle() { return stream_; }
  const VideoMode& mode() const { return mode_; }
  /// Frames of a recording; 0 for a device.
  int recorded_frames() const { return recorded_frames_; }

  /// A frame that waitForAnyStream() announced. Would block for ever when there is none.
  openni::VideoFrameRef read();

  /// Copies a frame of this stream into packed rows, upright; refuses one of another size or format.
  Status copy(const openni::VideoFrameRef& frame, std::span<std::uint16_t> pixels) const;

 private:
  OpenNiStream() = default;
  Status configure(OpenNiDevice& device);
  openni::VideoStream stream_;
  VideoMode mode_;
  bool flip_ = false;
  int recorded_frames_ = 0;
};

Moment moment_of(const openni::VideoFrameRef& frame);

}  // namespace calibrd
