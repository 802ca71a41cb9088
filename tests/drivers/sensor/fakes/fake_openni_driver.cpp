// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// An OpenNI2 driver that misbehaves on demand (fake_control.hpp). Loaded by the real OpenNI2 library.
#include <cstring>
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/drivers/sensor/fakes/fake_control.hpp"
#include "tests/drivers/sensor/fakes/test_pattern.hpp"

namespace calibrd::fake {
namespace {

[[noreturn]] void hang_for_ever() {
  while (true) ::pause();
}

int bytes_of(OniPixelFormat format) { return format == ONI_PIXEL_FORMAT_RGB888 ? 3 : 2; }

OniStatus give(const void* value, int size, void* data, int* data_size) {
  if (*data_size < size) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, value, static_cast<std::size_t>(size));
  *data_size = size;
  return ONI_STATUS_OK;
}

class FakeStream : public oni::driver::StreamBase {
 public:
  FakeStream(OniSensorType sensor, OniVideoMode mode, int device)
      : sensor_(sensor), mode_(mode), device_(device) {}

  OniStatus start() override { return running_ = true, ONI_STATUS_OK; }
  void stop() override { running_ = false; }

  int getRequiredFrameSize() override {
    return (mode_.resolutionX * bytes_of(mode_.pixelFormat) + read_control().row_padding) * mode_.resolutionY;
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_CROPPING ||
           id == ONI_STREAM_PROPERTY_MIRRORING;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    const OniCropping none{};
    const OniBool mirrored = read_control().mirrored;
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(&mode_, sizeof(mode_), data, size);
    if (id == ONI_STREAM_PROPERTY_CROPPING) return give(&none, sizeof(none), data, size);
    if (id == ONI_STREAM_PROPERTY_MIRRORING) return give(&mirrored, sizeof(mirrored), data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_STREAM_PROPERTY_VIDEO_MODE || size != sizeof(mode_)) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&mode_, data, sizeof(mode_));
    return ONI_STATUS_OK;
  }

  void deliver(int index, const Control& control) {
    if (!running_) return;
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    describe(*frame, index, control);
    draw(*frame, index, control.mirrored != 0);
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  void describe(OniFrame& frame, int index, const Control& control) const {
    frame.sensorType = sensor_;
    frame.videoMode = mode_;
    frame.width = control.frame_width > 0 ? control.frame_width : mode_.resolutionX;
    frame.height = mode_.resolutionY;
    frame.stride = mode_.resolutionX * bytes_of(mode_.pixelFormat) + control.row_padding;
    frame.dataSize = frame.stride * frame.height;
    frame.croppingEnabled = FALSE;
    frame.cropOriginX = frame.cropOriginY = 0;
    frame.frameIndex = control.numbered ? index : 0;
    const int shift_us = sensor_ == ONI_SENSOR_DEPTH ? 0 : control.image_shift_us;
    frame.timestamp =
        control.numbered ? static_cast<uint64_t>(1'000'000LL + index * (1'000'000LL / kFps) + shift_us) : 0;
  }

  void draw(OniFrame& frame, int index, bool mirrored) const {
    for (int y = 0; y < mode_.resolutionY; ++y) {
      auto* row = static_cast<std::uint8_t*>(frame.data) + y * frame.stride;
      std::memset(row, 0xee, static_cast<std::size_t>(frame.stride));
      for (int x = 0; x < mode_.resolutionX; ++x) {
        const int column = mirrored ? mode_.resolutionX - 1 - x : x;
        draw_pixel(row + column * bytes_of(mode_.pixelFormat), index, x, y);
      }
    }
  }

  void draw_pixel(std::uint8_t* pixel, int index, int x, int y) const {
    if (sensor_ == ONI_SENSOR_COLOR) {
      std::memset(pixel, color_at(index, x, y), 3);
      return;
    }
    const std::uint16_t value =
        sensor_ == ONI_SENSOR_DEPTH ? depth_at(index, device_, x, y) : infrared_at(index, x, y);
    std::memcpy(pixel, &value, sizeof(value));
  }

  OniSensorType sensor_;
  OniVideoMode mode_;
  int device_;
  std::atomic<bool> running_{false};
};

class FakeDriver;

class FakeDevice : public oni::driver::DeviceBase {
 public:
  FakeDevice(FakeDriver& driver, int number) : driver_(driver), number_(number) {
    const Control control = read_control();
    const auto depth = control.unit_100_um ? ONI_PIXEL_FORMAT_DEPTH_100_UM : ONI_PIXEL_FORMAT_DEPTH_1_MM;
    add_sensor(ONI_SENSOR_DEPTH, depth);
    if (control.infrared) add_sensor(ONI_SENSOR_IR, ONI_PIXEL_FORMAT_GRAY16);
    if (control.color) add_sensor(ONI_SENSOR_COLOR, ONI_PIXEL_FORMAT_RGB888);
    thread_ = std::thread([this] { run(); });
  }
  ~FakeDevice() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    stopped_.notify_all();
    thread_.join();
  }

  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
    *infos = infos_.data();
    *count = count_;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    for (int i = 0; i < count_; ++i) {
      if (infos_[static_cast<std::size_t>(i)].sensorType != sensor) continue;
      const std::lock_guard lock(mutex_);
      auto& stream = streams_[sensor];
      // The default is the larger mode, as with libfreenect2's driver: who wants the other must say so.
      stream = std::make_shared<FakeStream>(sensor, modes_[static_cast<std::size_t>(i)][0], number_);
      return stream.get();
    }
    return nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(streams_, [&](const auto& entry) { return entry.second.get() == stream; });
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER || id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    const std::string serial = "SN" + std::to_string(number_);
    if (id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER)
      return give(serial.c_str(), static_cast<int>(serial.size()) + 1, data, size);
    if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION)
      return give(&registration_, sizeof(registration_), data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(registration_))
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&registration_, data, sizeof(registration_));
    return ONI_STATUS_OK;
  }
  OniStatus tryManualTrigger() override {  // called by whoever waits for a frame
    if (read_control().hang == "wait") hang_for_ever();
    return ONI_STATUS_OK;
  }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || read_control().registers;
  }

 private:
  void add_sensor(OniSensorType sensor, OniPixelFormat format) {
    const auto i = static_cast<std::size_t>(count_++);
    modes_[i] = {OniVideoMode{format, kWidth * 2, kHeight * 2, kFps},
                 OniVideoMode{format, kWidth, kHeight, kFps}};
    infos_[i] = {sensor, static_cast<int>(modes_[i].size()), modes_[i].data()};
  }

  void run();
  bool wait_for_next_frame();
  std::vector<std::shared_ptr<FakeStream>> running_streams();

  FakeDriver& driver_;
  int number_;
  int count_ = 0;
  std::array<std::array<OniVideoMode, 2>, 3> modes_{};
  std::array<OniSensorInfo, 3> infos_{};
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::mutex mutex_;
  std::map<OniSensorType, std::shared_ptr<FakeStream>> streams_;
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;
};

class FakeDriver : public oni::driver::DriverBase {
 public:
  explicit FakeDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const auto status = DriverBase::initialize(connected, disconnected, changed, cookie);
    const Control control = read_control();
    if (control.hang == "create") hang_for_ever();
    for (int i = 0; i < control.devices; ++i) {
      const OniDeviceInfo info = describe(i);
      deviceConnected(&info);
    }
    return status;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    if (read_control().hang == "open") hang_for_ever();
    return new FakeDevice(*this, uri[std::strlen(uri) - 1] - '0');
  }
  void deviceClose(oni::driver::DeviceBase* device) override {
    if (read_control().hang == "close") hang_for_ever();
    delete device;
  }
  void shutdown() override {}

  void unplug(int number) {
    const OniDeviceInfo info = describe(number);
    deviceDisconnected(&info);
  }

 private:
  static OniDeviceInfo describe(int number) {
    OniDeviceInfo info{};
    std::snprintf(info.uri, sizeof(info.uri), "fake://sensor/%d", number);
    std::snprintf(info.vendor, sizeof(info.vendor), "Fake");
    std::snprintf(info.name, sizeof(info.name), "Sensor");
    return info;
  }
};

void FakeDevice::run() {
  bool is_plugged = true;
  int frames = 0;
  for (int index = 1; !wait_for_next_frame(); ++index) {
    const Control control = read_control();
    if (is_plugged && control.devices <= number_) driver_.unplug(number_);
    is_plugged = is_plugged && control.devices > number_;
    if (control.crash_after > 0 && frames >= control.crash_after) std::abort();
    const auto streams = running_streams();
    for (int i = 0; is_plugged && !control.silent && i < control.repeat; ++i)
      for (const auto& stream : streams) stream->deliver(index, control);
    if (!streams.empty()) ++frames;
    index += control.skip;
  }
}

/// True when the device is closed instead.
bool FakeDevice::wait_for_next_frame() {
  std::unique_lock lock(mutex_);
  return stopped_.wait_for(lock, std::chrono::microseconds(1'000'000 / kFps), [&] { return stop_; });
}

/// Copies: the library is called back without our lock, since it takes its own first when it calls us.
std::vector<std::shared_ptr<FakeStream>> FakeDevice::running_streams() {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<FakeStream>> streams;
  for (const auto& [sensor, stream] : streams_) streams.push_back(stream);
  return streams;
}

}  // namespace
}  // namespace calibrd::fake

using calibrd::fake::FakeDriver;
ONI_EXPORT_DRIVER(FakeDriver)
