// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/openni_device.hpp"

#include <array>

#include "drivers/sensor/child/device_choice.hpp"
#include "drivers/sensor/child/openni_stream.hpp"
#include "drivers/sensor/child/surroundings.hpp"

namespace calibrd {
namespace {

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '\t')) text.pop_back();
  return text;
}

std::string listing(const std::vector<OpenNi::Listed>& devices) {
  std::string text;
  for (const auto& device : devices) text += (text.empty() ? "" : ", ") + device.uri;
  return text.empty() ? "none" : text;
}

std::string asked_for(const std::string& device) {
  return device.empty() ? "any device" : "device '" + device + "'";
}

}  // namespace

Error openni_error(SensorError error, const std::string& detail) {
  const std::string said = trimmed(openni::OpenNI::getExtendedError());
  return sensor_error(error, said.empty() ? detail : detail + " (OpenNI2: " + said + ")");
}

Result<std::unique_ptr<OpenNi>> OpenNi::start() {
  if (openni::OpenNI::initialize() != openni::STATUS_OK)
    return openni_error(SensorError::openni_failed, describe_surroundings());
  return std::unique_ptr<OpenNi>(new OpenNi);
}

OpenNi::~OpenNi() { openni::OpenNI::shutdown(); }

std::vector<OpenNi::Listed> OpenNi::devices() const {
  openni::Array<openni::DeviceInfo> infos;
  openni::OpenNI::enumerateDevices(&infos);
  std::vector<Listed> listed;
  for (int i = 0; i < infos.getSize(); ++i)
    listed.push_back({infos[i].getUri(), std::string(infos[i].getVendor()) + " " + infos[i].getName()});
  return listed;
}

OpenNiDevice::OpenNiDevice() {
  openni::OpenNI::addDeviceDisconnectedListener(this);
  openni::OpenNI::addDeviceStateChangedListener(this);
}

OpenNiDevice::~OpenNiDevice() {
  openni::OpenNI::removeDeviceStateChangedListener(this);
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  device_.close();
}

Result<std::unique_ptr<OpenNiDevice>> OpenNiDevice::open(const OpenNi& library,
                                                         const StreamRequest& request) {
  if (request.recording.empty()) return open_chosen(library, request.device);
  auto device = open_uri(request.recording, SensorError::recording_unreadable);
  if (!device) return device;
  if (auto configured = (*device)->configure_playback(request); !configured) return configured.error();
  return device;
}

Result<std::unique_ptr<OpenNiDevice>> OpenNiDevice::open_uri(const std::string& uri, SensorError on_failure) {
  std::unique_ptr<OpenNiDevice> device(new OpenNiDevice);
  device->uri_ = uri;
  if (device->device_.open(uri.c_str()) != openni::STATUS_OK) return openni_error(on_failure, uri);
  return device;
}

Result<std::unique_ptr<OpenNiDevice>> OpenNiDevice::open_chosen(const OpenNi& library,
                                                                const std::string& device) {
  const DeviceChoice choice(device);
  const auto listed = library.devices();
  std::optional<Error> failure;
  for (const auto& [uri, name] : listed) {
    if (!choice.admits_uri(uri)) continue;
    auto opened = open_uri(uri, SensorError::open_failed);
    if (!opened)
      failure = opened.error();
    else if (choice.admits_serial((*opened)->serial()))
      return opened;
  }
  if (failure) return *failure;
  if (const auto uri = choice.exact_uri())
    if (auto opened = open_uri(*uri, SensorError::open_failed)) return opened;
  return sensor_error(SensorError::no_device,
                      asked_for(device) + "; found: " + listing(listed) + "; " + describe_surroundings());
}

Status OpenNiDevice::configure_playback(const StreamRequest& request) {
  openni::PlaybackControl* playback = device_.getPlaybackControl();
  if (playback == nullptr) return openni_error(SensorError::recording_unreadable, uri_);
  const bool is_set = playback->setSpeed(static_cast<float>(request.speed)) == openni::STATUS_OK &&
                      playback->setRepeatEnabled(request.loop) == openni::STATUS_OK;
  if (!is_set) return openni_error(SensorError::recording_unreadable, uri_);
  return Done{};
}

std::string OpenNiDevice::description() const {
  const openni::DeviceInfo& info = device_.getDeviceInfo();
  return std::string(info.getVendor()) + " " + info.getName() + " (" + uri_ + ")";
}

std::string OpenNiDevice::serial() const {
  std::array<char, 256> text{};
  int size = static_cast<int>(text.size()) - 1;
  if (device_.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, text.data(), &size) != openni::STATUS_OK)
    return {};
  return text.data();
}

std::vector<VideoMode> OpenNiDevice::modes(openni::SensorType sensor) {
  std::vector<VideoMode> modes;
  const openni::SensorInfo* info = device_.getSensorInfo(sensor);
  if (info == nullptr) return modes;
  const auto& offered = info->getSupportedVideoModes();
  for (int i = 0; i < offered.getSize(); ++i) modes.push_back(to_video_mode(offered[i]));
  return modes;
}

bool OpenNiDevice::is_this(const openni::DeviceInfo* info) const {
  return info != nullptr && uri_ == info->getUri();
}

void OpenNiDevice::onDeviceDisconnected(const openni::DeviceInfo* info) {
  if (is_this(info)) disconnected_ = true;
}

void OpenNiDevice::onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) {
  if (is_this(info) && state == openni::DEVICE_STATE_EOF) ended_ = true;
}

}  // namespace calibrd
