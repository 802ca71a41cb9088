// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "drivers/sim/model/description.hpp"
#include "drivers/sim/model/robot_file.hpp"
#include "drivers/sim/render/sensor_model.hpp"

namespace calibrd::sim::test {

inline std::filesystem::path demo_urdf() { return CALIBRD_DEMO_URDF; }
inline std::filesystem::path demo_world() { return CALIBRD_DEMO_WORLD; }

/// A description with the demo robot; `rest` continues the JSON object after the robot's key.
inline World world_from(const std::string& rest) {
  auto world = parse_description(R"({"robot": {})" + rest + "}", {}, {demo_urdf(), {}});
  if (!world) throw std::runtime_error(world.error().message());
  return std::move(*world);
}

/// A sensor 1.3 m in front of the demo robot, without any error.
inline constexpr const char* kPlainSensor =
    R"(, "sensors": [{"id": "eye", "position_m": [1.3, 0.2, 0.7], "target_m": [0, 0, 0.4]}])";

/// Waits until `condition` holds; false when it does not within `limit`.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::milliseconds limit = std::chrono::seconds(10)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

struct Exposure {
  std::vector<std::uint16_t> depth_mm, infrared;
};

inline Exposure expose(SensorModel& model, const WorldState& state, std::uint64_t seed = 1,
                       std::int64_t now_ns = 1'000'000'000) {
  const auto pixels = model.truth().depth_m.size();
  Exposure exposure{std::vector<std::uint16_t>(pixels), std::vector<std::uint16_t>(pixels)};
  model.expose(state, state.sensors[0], now_ns, seed, exposure.depth_mm, exposure.infrared);
  return exposure;
}

}  // namespace calibrd::sim::test
