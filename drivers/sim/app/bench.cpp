// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/app/bench.hpp"

#include <ctime>
#include <iomanip>
#include <iostream>

#include "drivers/sim/model/description.hpp"
#include "drivers/sim/render/sensor_model.hpp"
#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

double cpu_ms() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

std::size_t triangle_count(const Robot& robot) {
  std::size_t count = 0;
  for (const auto& link : robot.links) count += link.mesh.triangles.size();
  return count;
}

void measure(const World& world, const char* what, int frames, bool infrared) {
  const SensorState& sensor = world.state.sensors[0];
  const auto pixels = static_cast<std::size_t>(sensor.camera.width) * static_cast<std::size_t>(sensor.camera.height);
  std::vector<std::uint16_t> depth(pixels), counts(infrared ? pixels : 0);
  const double before = cpu_ms();
  SensorModel model(world.cell, sensor.camera);
  model.expose(world.state, sensor, monotonic_ns(), 0, depth, counts);
  const double ready = cpu_ms();
  const std::int64_t start_ns = monotonic_ns();
  std::size_t robot_pixels = 0;
  double worst = 0;
  for (int i = 1; i <= frames; ++i) {
    const double from = cpu_ms();
    model.expose(world.state, sensor, start_ns + i * 33'333'333LL, static_cast<std::uint64_t>(i), depth, counts);
    worst = std::max(worst, cpu_ms() - from);
    robot_pixels += model.robot_pixels();
  }
  const double mean = (cpu_ms() - ready) / frames;
  std::cout << std::fixed << std::setprecision(2) << what << ": mean " << mean << " ms, worst " << worst
            << " ms of CPU per frame; first frame " << ready - before << " ms; robot pixels "
            << robot_pixels / static_cast<std::size_t>(frames) << '\n';
}

}  // namespace

Status run_bench(const BenchOptions& options) {
  auto world = read_description(options.description, {options.urdf, options.models});
  if (!world) return world.error();
  if (world->state.sensor_count == 0) return sim_error(SimError::description_invalid, "sensors: none to measure");
  const SensorState& sensor = world->state.sensors[0];
  std::cout << sensor.camera.width << "x" << sensor.camera.height << ", robot of "
            << triangle_count(world->cell.robot) << " triangles, " << options.frames << " frames\n";
  measure(*world, "depth", options.frames, false);
  measure(*world, "depth and infrared", options.frames, true);
  return Done{};
}

}  // namespace calibrd::sim
