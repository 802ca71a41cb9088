// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <OpenNI.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sensor/child/video_mode.hpp"
#include "drivers/sensor/transport/sensor_error.hpp"
#include "drivers/sensor/transport/stream_request.hpp"

namespace calibrd {

/// An Error that carries what OpenNI2 itself said last.
Error openni_error(SensorError error, const std::string& detail);

/// The OpenNI2 library, started; stops it when destroyed. One at a time.
class OpenNi {
 public:
  static Result<std::unique_ptr<OpenNi>> start();
  ~OpenNi();
  OpenNi(const OpenNi&) = delete;
  OpenNi& operator=(const OpenNi&) = delete;

  struct Listed {
    std::string uri, name;  ///< name: vendor and product
  };
  std::vector<Listed> devices() const;

 private:
  OpenNi() = default;
};

/// One open device or recording.
class OpenNiDevice : openni::OpenNI::DeviceDisconnectedListener, openni::OpenNI::DeviceStateChangedListener {
 public:
  /// Opens what the request asks for.
  static Result<std::unique_ptr<OpenNiDevice>> open(const OpenNi& library, const StreamRequest& request);
  ~OpenNiDevice() override;
  OpenNiDevice(const OpenNiDevice&) = delete;
  OpenNiDevice& operator=(const OpenNiDevice&) = delete;

  openni::Device& handle() { return device_; }
  /// Vendor, name and URI.
  std::string description() const;
  std::string serial() const;
  std::vector<VideoMode> modes(openni::SensorType sensor);

  /// Set by the driver's thread.
  bool is_disconnected() const { return disconnected_; }
  bool has_ended() const { return ended_; }

 private:
  OpenNiDevice();
  static Result<std::unique_ptr<OpenNiDevice>> open_uri(const std::string& uri, SensorError on_failure);
  static Result<std::unique_ptr<OpenNiDevice>> open_chosen(const OpenNi& library, const std::string& device);
  Status configure_playback(const StreamRequest& request);
  bool is_this(const openni::DeviceInfo* info) const;
  void onDeviceDisconnected(const openni::DeviceInfo* info) override;
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override;

  openni::Device device_;
  std::string uri_;
  std::atomic<bool> disconnected_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace calibrd
