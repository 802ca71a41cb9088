// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/app/record.hpp"

#include <iostream>

#include "drivers/sim/model/robot_file.hpp"
#include "drivers/sim/scenes/capture_folder.hpp"

namespace calibrd::sim {

Status record_captures(const RecordOptions& options) {
  std::vector<Robot> robots;
  for (const auto& urdf : options.urdfs) {
    auto robot = read_robot(urdf, {options.models, ""});
    if (!robot) return robot.error();
    robots.push_back(std::move(*robot));
  }
  CameraParameters camera;
  if (options.distorted) camera.distortion = {0.0905, -0.268, 0, 0, 0.0951};
  const auto tables = std::make_shared<const SensorTables>(camera);
  for (std::uint64_t seed = options.seed; seed < options.seed + options.scenes; ++seed) {
    const std::size_t robot = seed % robots.size();
    const auto capture = simulate_capture(robots[robot], seed, options.capture, tables);
    if (!capture) return capture.error();
    const auto folder =
        options.scenes == 1 ? options.folder : options.folder / ("scene_" + std::to_string(seed));
    const std::string reference = options.urdf_reference.empty()
                                      ? std::filesystem::absolute(options.urdfs[robot]).string()
                                      : options.urdf_reference;
    if (auto written = write_capture_folder(folder, *capture, reference); !written) return written;
    std::cout << folder.string() << '\n';
  }
  return Done{};
}

}  // namespace calibrd::sim
