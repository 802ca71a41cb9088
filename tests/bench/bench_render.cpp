// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bench.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd::bench {
namespace {

/// A sensor `distance_m` from the middle of the arm, looking at it from in front and above.
Pose looking_at_arm(double distance_m) {
  const Eigen::Vector3d target(0, 0, 0.55);
  const Eigen::Vector3d position = target + distance_m * Eigen::Vector3d(0.8, 0.45, 0.4).normalized();
  const Eigen::Vector3d z = (target - position).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Pose T = Pose::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = position;
  return T;
}

}  // namespace

int run_render(const RenderOptions& options) {
  auto robot = RobotModel::load(options.urdf, {options.models, ""});
  if (!robot) return stop(robot.error().message());
  const CameraModel kinect2{512, 424, 365.456, 365.456, 254.878, 205.395, {0.0905, -0.268, 0, 0, 0.0951}};
  VirtualCell cell(*robot);
  VirtualMeasurement image;
  const Pose T_base_sensor = looking_at_arm(options.distance_m);
  std::vector<double> joints(robot->position_count()), milliseconds;
  std::size_t fewest_pixels = SIZE_MAX;
  for (int run = -5; run < options.runs; ++run) {  // the first ones warm up
    for (std::size_t j = 0; j < joints.size(); ++j)
      joints[j] = 0.3 * std::sin(0.1 * run + static_cast<double>(j));
    const auto begin = std::chrono::steady_clock::now();
    cell.set_joints(joints);
    cell.measure(kinect2, T_base_sensor, image);
    const auto end = std::chrono::steady_clock::now();
    fewest_pixels = std::min(fewest_pixels, static_cast<std::size_t>(std::ranges::count_if(
                                                image.link, [](auto link) { return link >= 0; })));
    if (run >= 0) milliseconds.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
  }
  std::printf("{\"median_ms\": %.3f, \"width\": %d, \"height\": %d, \"fewest_robot_pixels\": %zu}\n",
              median(milliseconds), image.width, image.height, fewest_pixels);
  return 0;
}

}  // namespace calibrd::bench
