// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <mutex>
#include <span>

#include "drivers/sim/openni/openni_api.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

class SimDevice;

/// The depth or the infrared stream of a simulated sensor. Calls come from OpenNI2's threads, deliver() from the
/// device's.
class SimStream final : public oni::driver::StreamBase {
 public:
  SimStream(SimDevice& device, OniSensorType type, const CameraParameters& camera, double rate_hz);

  OniStatus start() override;
  void stop() override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniBool isPropertySupported(int id) override;
  void notifyAllProperties() override;

  OniSensorType type() const { return type_; }
  bool is_started();
  /// Hands one image to OpenNI2; after stop() has returned, none any more.
  void deliver(std::span<const std::uint16_t> pixels, std::uint64_t timestamp_us, int index);

  /// The one mode a stream of this kind has.
  static OniVideoMode video_mode(OniSensorType type, const CameraParameters& camera, double rate_hz);

 private:
  void copy_pixels(std::span<const std::uint16_t> pixels, std::uint16_t* to) const;

  SimDevice& device_;
  const OniSensorType type_;
  const CameraParameters camera_;
  const OniVideoMode mode_;
  std::mutex mutex_;  // guards the two below and is held while a frame is handed over
  bool started_ = false;
  bool mirrored_ = false;
};

}  // namespace calibrd::sim
