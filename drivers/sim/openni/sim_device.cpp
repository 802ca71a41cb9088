// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/openni/sim_device.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>

namespace calibrd::sim {
namespace {

std::chrono::steady_clock::time_point time_point_of(std::int64_t ns) {
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(ns));
}

constexpr std::chrono::milliseconds kHangPoll{20};

}  // namespace

SimDevice::SimDevice(std::shared_ptr<const WorldView> world, std::size_t sensor, const SensorState& at_start)
    : world_(std::move(world)), sensor_(sensor), camera_(at_start.camera), rate_hz_(at_start.rate_hz) {
  constexpr std::array kTypes{ONI_SENSOR_DEPTH, ONI_SENSOR_IR};
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    modes_[i] = SimStream::video_mode(kTypes[i], camera_, rate_hz_);
    infos_[i] = {kTypes[i], 1, &modes_[i]};
  }
  thread_ = std::thread([this] { run(); });
  // So that what the simulator costs can be told from what its client costs, in whose process it runs.
  pthread_setname_np(thread_.native_handle(), "sim-render");
}

SimDevice::~SimDevice() {
  wait_while_hanging();
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

OniStatus SimDevice::getSensorInfoList(OniSensorInfo** infos, int* count) {
  *infos = infos_.data();
  *count = static_cast<int>(infos_.size());
  return ONI_STATUS_OK;
}

oni::driver::StreamBase* SimDevice::createStream(OniSensorType type) {
  wait_while_hanging();
  if (type != ONI_SENSOR_DEPTH && type != ONI_SENSOR_IR) return nullptr;
  const std::lock_guard lock(mutex_);
  return streams_.emplace_back(new SimStream(*this, type, camera_, rate_hz_));
}

void SimDevice::destroyStream(oni::driver::StreamBase* stream) {
  wait_while_hanging();
  const std::lock_guard lock(mutex_);  // not while the thread hands frames over
  std::erase(streams_, stream);
  delete stream;
}

OniStatus SimDevice::getProperty(int id, void* data, int* size) {
  wait_while_hanging();
  const std::string serial = "calibrd-sim-" + std::to_string(sensor_);
  const auto needed = static_cast<int>(serial.size()) + 1;
  if (id != ONI_DEVICE_PROPERTY_SERIAL_NUMBER || *size < needed) return ONI_STATUS_NOT_SUPPORTED;
  std::memcpy(data, serial.c_str(), serial.size() + 1);
  *size = needed;
  return ONI_STATUS_OK;
}

std::optional<WorldState> SimDevice::world_now() const {
  if (!world_->alive(monotonic_ns())) return std::nullopt;
  return world_->read();
}

void SimDevice::wait_while_hanging() {
  for (auto state = world_now(); state && state->sensors[sensor_].mode == SensorMode::hanging;
       state = world_now())
    std::this_thread::sleep_for(kHangPoll);
}

void SimDevice::wake() { changed_.notify_all(); }

bool SimDevice::any_started() {
  const std::lock_guard lock(mutex_);
  return std::any_of(streams_.begin(), streams_.end(),
                     [](SimStream* stream) { return stream->is_started(); });
}

/// False when the device is being closed.
bool SimDevice::wait_until(std::int64_t time_ns) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_until(lock, time_point_of(time_ns), [this] { return closing_; });
}

void SimDevice::expose(const WorldState& state, std::int64_t exposure_ns, std::int64_t frame,
                       Images& images) {
  bool infrared = false;
  {
    const std::lock_guard lock(mutex_);
    for (SimStream* stream : streams_)
      infrared = infrared || (stream->type() == ONI_SENSOR_IR && stream->is_started());
  }
  if (!model_) model_ = std::make_unique<SensorModel>(world_->cell(), camera_);
  const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  images.depth.resize(pixels);
  images.infrared.resize(infrared ? pixels : 0);
  const std::uint64_t seed = static_cast<std::uint64_t>(frame) * kMaxSensors + sensor_;
  model_->expose(state, state.sensors[sensor_], exposure_ns, seed, images.depth, images.infrared);
}

/// Each moment of a second is rendered once while frames are replayed, and shown again in the next.
const SimDevice::Images& SimDevice::images_of(const WorldState& state, std::int64_t exposure_ns,
                                              std::int64_t frame) {
  const bool replays = state.sensors[sensor_].mode == SensorMode::replay;
  if (!replays) replayed_ = {};
  Images& images = replays ? replayed_[static_cast<std::size_t>(frame) % replayed_.size()] : newest_;
  if (!replays || images.depth.empty()) expose(state, exposure_ns, frame, images);
  return images;
}

void SimDevice::deliver(const Images& images, std::int64_t exposure_ns, std::int64_t frame) {
  const std::lock_guard lock(mutex_);
  for (SimStream* stream : streams_) {
    const auto& pixels = stream->type() == ONI_SENSOR_DEPTH ? images.depth : images.infrared;
    if (!pixels.empty())
      stream->deliver(pixels, static_cast<std::uint64_t>(exposure_ns / 1000),
                      static_cast<int>(frame - first_frame_));
  }
}

void SimDevice::run() {
  const double period_ns = 1e9 / rate_hz_;
  const auto frame_after = [&](std::int64_t ns) {
    return static_cast<std::int64_t>(static_cast<double>(ns) / period_ns) + 1;
  };
  std::int64_t frame = frame_after(monotonic_ns());
  first_frame_ = frame - 1;
  for (;;) {
    const auto exposure_ns = static_cast<std::int64_t>(static_cast<double>(frame) * period_ns);
    if (!wait_until(exposure_ns)) return;
    const auto state = world_now();
    const auto mode = state ? state->sensors[sensor_].mode : SensorMode::silent;
    if ((mode == SensorMode::normal || mode == SensorMode::replay) && any_started()) {
      const Images& images = images_of(*state, exposure_ns, frame);
      if (!wait_until(exposure_ns + std::llround(state->sensors[sensor_].latency_s * 1e9))) return;
      deliver(images, exposure_ns, frame);
    }
    frame = std::max(frame + 1,
                     frame_after(monotonic_ns()));  // too slow a machine loses frames, as a sensor does
  }
}

}  // namespace calibrd::sim
