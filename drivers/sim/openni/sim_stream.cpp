// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/openni/sim_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "drivers/sim/openni/sim_device.hpp"

namespace calibrd::sim {
namespace {

constexpr int kDepthMaximum = 10000, kInfraredMaximum = 65535;  // the recorder wants depth well below 32768

template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = static_cast<int>(sizeof(T));
  return ONI_STATUS_OK;
}

template <class T>
bool take(const void* data, int size, T& value) {
  if (size != static_cast<int>(sizeof(T))) return false;
  std::memcpy(&value, data, sizeof(T));
  return true;
}

float field_of_view(double size_px, double focal_px) {
  return static_cast<float>(2 * std::atan(size_px / (2 * focal_px)));
}

}  // namespace

SimStream::SimStream(SimDevice& device, OniSensorType type, const CameraParameters& camera, double rate_hz)
    : device_(device), type_(type), camera_(camera), mode_(video_mode(type, camera, rate_hz)) {}

OniVideoMode SimStream::video_mode(OniSensorType type, const CameraParameters& camera, double rate_hz) {
  OniVideoMode mode{};
  mode.pixelFormat = type == ONI_SENSOR_DEPTH ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_GRAY16;
  mode.resolutionX = camera.width;
  mode.resolutionY = camera.height;
  mode.fps = static_cast<int>(std::lround(rate_hz));
  return mode;
}

bool SimStream::is_started() {
  const std::lock_guard lock(mutex_);
  return started_;
}

OniStatus SimStream::start() {
  device_.wait_while_hanging();
  {
    const std::lock_guard lock(mutex_);
    started_ = true;
  }
  device_.wake();
  return ONI_STATUS_OK;
}

void SimStream::stop() {
  device_.wait_while_hanging();
  const std::lock_guard lock(mutex_);
  started_ = false;
}

OniStatus SimStream::getProperty(int id, void* data, int* size) {
  device_.wait_while_hanging();
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give(mode_, data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // players of .oni files need an answer, if only "off"
      return give(OniCropping{0, 0, 0, camera_.width, camera_.height}, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return give(field_of_view(camera_.width, camera_.fx), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give(field_of_view(camera_.height, camera_.fy), data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return give(type_ == ONI_SENSOR_DEPTH ? kDepthMaximum : kInfraredMaximum, data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return give(0, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give(static_cast<int>(camera_.width * sizeof(std::uint16_t)), data, size);
    case ONI_STREAM_PROPERTY_MIRRORING: {
      const std::lock_guard lock(mutex_);
      return give(static_cast<OniBool>(mirrored_), data, size);
    }
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus SimStream::setProperty(int id, const void* data, int size) {
  device_.wait_while_hanging();
  if (OniVideoMode mode{}; id == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    if (!take(data, size, mode)) return ONI_STATUS_BAD_PARAMETER;
    const bool same = mode.pixelFormat == mode_.pixelFormat && mode.resolutionX == mode_.resolutionX &&
                      mode.resolutionY == mode_.resolutionY && mode.fps == mode_.fps;
    return same ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
  }
  if (OniBool mirrored = 0; id == ONI_STREAM_PROPERTY_MIRRORING) {
    if (!take(data, size, mirrored)) return ONI_STATUS_BAD_PARAMETER;
    const std::lock_guard lock(mutex_);
    mirrored_ = mirrored != 0;
    return ONI_STATUS_OK;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool SimStream::isPropertySupported(int id) {
  return static_cast<OniBool>(id >= ONI_STREAM_PROPERTY_CROPPING && id <= ONI_STREAM_PROPERTY_MIRRORING);
}

void SimStream::notifyAllProperties() {
  for (int id = ONI_STREAM_PROPERTY_CROPPING; id <= ONI_STREAM_PROPERTY_MIRRORING; ++id) {
    char buffer[64];
    int size = sizeof(buffer);
    if (getProperty(id, buffer, &size) == ONI_STATUS_OK) raisePropertyChanged(id, buffer, size);
  }
}

void SimStream::copy_pixels(std::span<const std::uint16_t> pixels, std::uint16_t* to) const {
  const auto width = static_cast<std::size_t>(camera_.width);
  for (std::size_t row = 0; row < pixels.size(); row += width) {
    const auto line = pixels.subspan(row, width);
    if (mirrored_)
      std::reverse_copy(line.begin(), line.end(), to + row);
    else
      std::copy(line.begin(), line.end(), to + row);
  }
}

void SimStream::deliver(std::span<const std::uint16_t> pixels, std::uint64_t timestamp_us, int index) {
  const std::lock_guard lock(mutex_);
  if (!started_) return;
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  const int size = static_cast<int>(pixels.size_bytes());
  if (frame->data != nullptr && frame->dataSize >= size) {
    copy_pixels(pixels, static_cast<std::uint16_t*>(frame->data));
    frame->dataSize = size;
    frame->frameIndex = index;
    frame->timestamp = timestamp_us;
    frame->sensorType = type_;
    frame->videoMode = mode_;
    frame->width = camera_.width;
    frame->height = camera_.height;
    frame->stride = static_cast<int>(camera_.width * sizeof(std::uint16_t));
    frame->croppingEnabled = 0;
    frame->cropOriginX = 0;
    frame->cropOriginY = 0;
    raiseNewFrame(frame);
  }
  getServices().releaseFrame(frame);
}

}  // namespace calibrd::sim
