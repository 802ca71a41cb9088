// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "drivers/sim/render/depth_model.hpp"
#include "drivers/sim/render/infrared_model.hpp"
#include "drivers/sim/render/scene_renderer.hpp"

namespace calibrd::sim {

/// A simulated time-of-flight sensor: exposes the world at a moment into a depth and an infrared image. One thread;
/// `cell` must outlive it.
class SensorModel {
 public:
  SensorModel(const Cell& cell, const CameraParameters& camera)
      : renderer_(cell, camera),
        depth_(camera.width, camera.height, white_, correlated_),
        infrared_(camera.width, camera.height, white_) {}
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  /// `now_ns`: the exposure, on CLOCK_MONOTONIC. `seed`: of the frame's noise; the same seed gives the same frame.
  /// `depth_mm`: width * height values. `counts`: as many, or empty when nobody wants the infrared image.
  void expose(const WorldState& world, const SensorState& sensor, std::int64_t now_ns, std::uint64_t seed,
              std::span<std::uint16_t> depth_mm, std::span<std::uint16_t> counts);

  /// Without errors, of the last exposure.
  const PixelTruth& truth() const { return renderer_.truth(); }
  std::size_t robot_pixels() const;

 private:
  NoiseField white_{false}, correlated_{true};
  SceneRenderer renderer_;
  DepthModel depth_;
  InfraredModel infrared_;
};

}  // namespace calibrd::sim
