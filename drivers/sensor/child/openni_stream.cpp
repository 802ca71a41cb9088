// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/openni_stream.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace calibrd {
namespace {

constexpr std::array<std::pair<openni::PixelFormat, PixelFormat>, 7> kFormats{{
    {openni::PIXEL_FORMAT_DEPTH_1_MM, PixelFormat::depth_1_mm},
    {openni::PIXEL_FORMAT_DEPTH_100_UM, PixelFormat::depth_100_um},
    {openni::PIXEL_FORMAT_GRAY8, PixelFormat::grey8},
    {openni::PIXEL_FORMAT_GRAY16, PixelFormat::grey16},
    {openni::PIXEL_FORMAT_RGB888, PixelFormat::rgb888},
    {openni::PIXEL_FORMAT_YUV422, PixelFormat::yuv422},
    {openni::PIXEL_FORMAT_YUYV, PixelFormat::yuyv},
}};

PixelFormat from_openni(openni::PixelFormat format) {
  for (const auto& [theirs, ours] : kFormats)
    if (theirs == format) return ours;
  return PixelFormat::other;
}

openni::VideoMode to_openni(const VideoMode& mode) {
  openni::VideoMode result;
  for (const auto& [theirs, ours] : kFormats)
    if (ours == mode.format) result.setPixelFormat(theirs);
  result.setResolution(mode.width, mode.height);
  result.setFps(mode.fps);
  return result;
}

RawFrame describe(const openni::VideoFrameRef& frame) {
  const auto size = static_cast<std::size_t>(std::max(frame.getDataSize(), 0));
  return {.format = from_openni(frame.getVideoMode().getPixelFormat()),
          .width = frame.getWidth(),
          .height = frame.getHeight(),
          .stride_bytes = frame.getStrideInBytes(),
          .is_cropped = frame.getCroppingEnabled(),
          .data = {static_cast<const std::byte*>(frame.getData()), frame.getData() == nullptr ? 0 : size}};
}

}  // namespace

VideoMode to_video_mode(const openni::VideoMode& mode) {
  return {from_openni(mode.getPixelFormat()), mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
}

Moment moment_of(const openni::VideoFrameRef& frame) { return {frame.getFrameIndex(), frame.getTimestamp()}; }

Result<std::unique_ptr<OpenNiStream>> OpenNiStream::create(OpenNiDevice& device, openni::SensorType sensor,
                                                           const VideoMode& mode, bool mirror) {
  std::unique_ptr<OpenNiStream> stream(new OpenNiStream);
  stream->mode_ = mode;
  stream->flip_ = mirror;
  if (stream->stream_.create(device.handle(), sensor) != openni::STATUS_OK)
    return openni_error(SensorError::stream_failed, device.description());
  if (auto configured = stream->configure(device); !configured) return configured.error();
  return stream;
}

Status OpenNiStream::configure(OpenNiDevice& device) {
  const bool is_set = to_video_mode(stream_.getVideoMode()) == mode_ ||
                      stream_.setVideoMode(to_openni(mode_)) == openni::STATUS_OK;
  if (!is_set || to_video_mode(stream_.getVideoMode()) != mode_)
    return openni_error(SensorError::mode_not_offered,
                        calibrd::describe(std::span(&mode_, 1)) + " was refused");
  if (stream_.isCroppingSupported()) stream_.resetCropping();  // every frame is checked for it anyway
  stream_.setMirroringEnabled(false);
  // A recording cannot be told so; it says how it was made.
  if (stream_.getMirroringEnabled()) flip_ = !flip_;
  if (openni::PlaybackControl* playback = device.handle().getPlaybackControl())
    recorded_frames_ = playback->getNumberOfFrames(stream_);
  return Done{};
}

OpenNiStream::~OpenNiStream() {
  stream_.stop();
  stream_.destroy();
}

Status OpenNiStream::start() {
  if (stream_.start() != openni::STATUS_OK)
    return openni_error(SensorError::stream_failed, "starting the stream");
  return Done{};
}

openni::VideoFrameRef OpenNiStream::read() {
  openni::VideoFrameRef frame;
  stream_.readFrame(&frame);
  return frame;
}

Status OpenNiStream::copy(const openni::VideoFrameRef& frame, std::span<std::uint16_t> pixels) const {
  const RawFrame raw = describe(frame);
  if (auto checked = check_frame(raw, mode_.format, mode_.width, mode_.height); !checked) return checked;
  copy_pixels(raw, flip_, pixels);
  return Done{};
}

}  // namespace calibrd
