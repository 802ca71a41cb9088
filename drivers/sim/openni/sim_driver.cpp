// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The simulated sensor as OpenNI2 sees it: libcalibrd_sim.so.0. CALIBRD_SIM_WORLD names the world it looks
// into.
#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "drivers/sim/openni/openni_api.hpp"
#include "drivers/sim/openni/sim_device.hpp"
#include "drivers/sim/openni/world_watch.hpp"

namespace calibrd::sim {
namespace {

constexpr std::chrono::milliseconds kLook{50};

OniDeviceInfo device_info(std::size_t sensor) {
  OniDeviceInfo info{};
  std::snprintf(info.uri, sizeof(info.uri), "calibrd-sim://%zu", sensor);
  std::snprintf(info.vendor, sizeof(info.vendor), "calibrd");
  std::snprintf(info.name, sizeof(info.name), "Simulated Kinect v2");
  return info;
}

std::filesystem::path world_path() {
  const char* path = std::getenv(kWorldVariable);
  return path != nullptr ? path : "";
}

}  // namespace

/// Announces sensors as they are plugged in and out, and opens them.
class SimDriver final : public oni::driver::DriverBase {
 public:
  explicit SimDriver(OniDriverServices* services) : DriverBase(services), watch_(world_path()) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, changed, cookie);
    look();  // so that a client that lists the devices at once finds them
    thread_ = std::thread([this] {
      std::unique_lock lock(mutex_);
      while (!wake_.wait_for(lock, kLook, [this] { return ending_; })) {
        lock.unlock();
        look();
        lock.lock();
      }
    });
    return status;
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    const auto world = watch_.current();
    const auto state = world ? world->read() : std::nullopt;
    if (!state) return nullptr;
    for (std::size_t i = 0; i < static_cast<std::size_t>(state->sensor_count); ++i) {
      if (std::string(device_info(i).uri) != uri || state->sensors[i].mode == SensorMode::unplugged) continue;
      auto* device = new SimDevice(world, i, state->sensors[i]);
      const std::lock_guard lock(mutex_);
      open_[device] = state->sensors[i].crashes;
      return device;
    }
    return nullptr;
  }

  void deviceClose(oni::driver::DeviceBase* device) override {
    {
      const std::lock_guard lock(mutex_);
      open_.erase(static_cast<SimDevice*>(device));
    }
    delete device;
  }

  OniStatus tryDevice(const char* uri) override {
    return std::string(uri).starts_with("calibrd-sim://") ? ONI_STATUS_OK : ONI_STATUS_ERROR;
  }

 private:
  void look() {
    const auto world = watch_.current();
    const auto state = world ? world->read() : std::nullopt;
    if (state) crash_where_told(*state);
    for (std::size_t i = 0; i < announced_.size(); ++i) {
      const bool present = state && i < static_cast<std::size_t>(state->sensor_count) &&
                           state->sensors[i].mode != SensorMode::unplugged;
      const auto now = present ? world : nullptr;
      if (now == announced_[i]) continue;
      const OniDeviceInfo info = device_info(i);
      if (announced_[i]) deviceDisconnected(&info);
      if (now) deviceConnected(&info);
      announced_[i] = now;
    }
  }

  void crash_where_told(const WorldState& state) {
    const std::lock_guard lock(mutex_);
    for (const auto& [device, crashes_at_opening] : open_)
      if (state.sensors[device->sensor()].crashes > crashes_at_opening) std::abort();
  }

  WorldWatch watch_;
  std::array<std::shared_ptr<const WorldView>, kMaxSensors> announced_;  // initialize()'s, then the thread's
  std::mutex mutex_;                                                     // guards what follows
  std::condition_variable wake_;
  std::map<SimDevice*, std::uint32_t> open_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace calibrd::sim

ONI_EXPORT_DRIVER(calibrd::sim::SimDriver)
