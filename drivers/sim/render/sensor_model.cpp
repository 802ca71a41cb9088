// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/sensor_model.hpp"

#include <algorithm>

namespace calibrd::sim {

void SensorModel::expose(const WorldState& world, const SensorState& sensor, std::int64_t now_ns, std::uint64_t seed,
                         std::span<std::uint16_t> depth_mm, std::span<std::uint16_t> counts) {
  renderer_.render(world, sensor.T_base_sensor.pose(), sensor.infrared.texture, now_ns);
  Random random(seed);
  const double age_s = static_cast<double>(now_ns - sensor.powered_ns) * 1e-9;
  depth_.measure(renderer_.truth(), renderer_.changed(), sensor.depth, std::max(age_s, 0.0), random, depth_mm);
  if (counts.empty())
    infrared_.forget();
  else
    infrared_.measure(renderer_.truth(), renderer_.changed(), sensor.infrared, random, counts);
}

std::size_t SensorModel::robot_pixels() const {
  return static_cast<std::size_t>(std::count(truth().robot.begin(), truth().robot.end(), std::uint8_t{1}));
}

}  // namespace calibrd::sim
