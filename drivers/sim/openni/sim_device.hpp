// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/sim/openni/openni_api.hpp"
#include "drivers/sim/openni/sim_stream.hpp"
#include "drivers/sim/render/sensor_model.hpp"
#include "drivers/sim/world/world_file.hpp"

namespace calibrd::sim {

/// A simulated sensor that a client has opened. A thread of its own exposes the world at the sensor's rate
/// and hands the images over, as late as the sensor's latency says.
class SimDevice final : public oni::driver::DeviceBase {
 public:
  SimDevice(std::shared_ptr<const WorldView> world, std::size_t sensor, const SensorState& at_start);
  ~SimDevice() override;

  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override;
  oni::driver::StreamBase* createStream(OniSensorType type) override;
  void destroyStream(oni::driver::StreamBase* stream) override;
  OniStatus getProperty(int id, void* data, int* size) override;

  /// Blocks for as long as the sensor is told to hang: that is what a hanging driver does to its caller.
  void wait_while_hanging();
  /// A stream was started.
  void wake();
  std::size_t sensor() const { return sensor_; }

 private:
  struct Images {
    std::vector<std::uint16_t> depth, infrared;
  };

  void run();
  bool any_started();
  bool wait_until(std::int64_t time_ns);
  std::optional<WorldState> world_now() const;
  void expose(const WorldState& state, std::int64_t exposure_ns, std::int64_t frame, Images& images);
  const Images& images_of(const WorldState& state, std::int64_t exposure_ns, std::int64_t frame);
  void deliver(const Images& images, std::int64_t exposure_ns, std::int64_t frame);

  const std::shared_ptr<const WorldView> world_;
  const std::size_t sensor_;
  const CameraParameters camera_;
  const double rate_hz_;
  std::array<OniVideoMode, 2> modes_;
  std::array<OniSensorInfo, 2> infos_;
  std::unique_ptr<SensorModel> model_;  // the thread's
  std::int64_t first_frame_ = 0;        // the thread's
  Images newest_;                       // the thread's
  std::array<Images, 30> replayed_;     // the thread's; empty: not rendered yet

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::vector<SimStream*> streams_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace calibrd::sim
