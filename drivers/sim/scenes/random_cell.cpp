// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/scenes/random_cell.hpp"

#include <numbers>
#include <string>

namespace calibrd::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFloor_m = -0.8;

Eigen::Isometry3d upright(const Eigen::Vector3d& position, double yaw_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = position;
  return pose;
}

/// A place around the base's axis.
Eigen::Vector2d around(Random& random, double nearest_m, double farthest_m) {
  const double angle = random.uniform(-kPi, kPi), radius = random.uniform(nearest_m, farthest_m);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

void add(FurnishedCell& furnished, Random& random, const std::string& name, Mesh mesh,
         const Eigen::Isometry3d& pose) {
  const auto index = static_cast<std::size_t>(furnished.state.object_count++);
  const Surface surface{static_cast<float>(random.uniform(0.15, 0.85)),
                        static_cast<float>(random.uniform(0.0, 0.4)),
                        static_cast<std::uint32_t>(random.bits() >> 32)};
  furnished.cell.objects.push_back({name, std::move(mesh), surface});
  furnished.state.objects[index] = {PoseValues::of(pose), 1};
}

/// A bench under the robot, on a pedestal, with boxes on it.
void add_bench(FurnishedCell& furnished, Random& random) {
  const Eigen::Vector3d size(random.uniform(0.9, 1.8), random.uniform(0.8, 1.4), 0.05);
  const Eigen::Isometry3d T_base_bench =
      upright({random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0}, random.uniform(-kPi, kPi));
  add(furnished, random, "bench", make_box(size), T_base_bench * Eigen::Translation3d(0, 0, -0.5 * size.z()));
  add(furnished, random, "pedestal", make_box({0.3, 0.3, -kFloor_m - size.z()}),
      T_base_bench * Eigen::Translation3d(0, 0, 0.5 * (kFloor_m - size.z())));
  auto boxes = 2 + random.bits() % 5;
  for (int tries = 0; boxes > 0 && tries < 100; ++tries) {
    const Eigen::Vector3d box(random.uniform(0.08, 0.35), random.uniform(0.08, 0.35),
                              random.uniform(0.05, 0.35));
    const Eigen::Vector3d place(random.uniform(-0.45, 0.45) * size.x(),
                                random.uniform(-0.45, 0.45) * size.y(), 0.5 * box.z());
    const Eigen::Isometry3d pose = T_base_bench * upright(place, random.uniform(-kPi, kPi));
    if (pose.translation().head<2>().norm() < 0.2 + 0.5 * box.head<2>().norm())
      continue;  // the robot's foot is there
    add(furnished, random, "box", make_box(box), pose);
    --boxes;
  }
}

void add_room(FurnishedCell& furnished, Random& random) {
  add(furnished, random, "floor", make_box({9, 9, 0.1}), upright({0, 0, kFloor_m - 0.05}, 0));
  const auto walls = 1 + random.bits() % 2;
  double yaw = random.uniform(-kPi, kPi);
  for (std::uint64_t i = 0; i < walls; ++i, yaw += 0.5 * kPi) {
    const double away = random.uniform(1.1, 2.5);
    add(furnished, random, "wall", make_box({0.1, 7, 3.5}),
        upright({away * std::cos(yaw), away * std::sin(yaw), kFloor_m + 1.75}, yaw));
  }
  const auto posts = random.bits() % 4;
  for (std::uint64_t i = 0; i < posts; ++i) {
    const Eigen::Vector2d place = around(random, 0.7, 1.6);
    const bool round = random.chance(0.5);
    const double width = random.uniform(0.03, 0.12), height = random.uniform(1.0, 2.4);
    add(furnished, random, "post",
        round ? make_cylinder(0.5 * width, height) : make_box({width, width, height}),
        upright({place.x(), place.y(), kFloor_m + 0.5 * height}, random.uniform(-kPi, kPi)));
  }
}

void add_company(FurnishedCell& furnished, Random& random) {
  WorldState& state = furnished.state;
  if (random.chance(0.35)) {
    const Eigen::Vector2d place = around(random, 1.0, 1.8);
    add(furnished, random, "other_pedestal", make_box({0.4, 0.4, -kFloor_m}),
        upright({place.x(), place.y(), 0.5 * kFloor_m}, 0));
    state.other_robot.present = 1;
    state.other_robot.T_base_other =
        PoseValues::of(upright({place.x(), place.y(), 0}, random.uniform(-kPi, kPi)));
    for (std::size_t j = 0; j < furnished.cell.robot.positions.size(); ++j)
      state.other_robot.joints[j] = random.uniform(-1, 1);
  }
  if (random.chance(0.2)) {
    const Eigen::Vector2d from = around(random, 1.0, 1.8), to = around(random, 1.0, 1.8);
    state.person = {1, 0, {from.x(), from.y()}, {to.x(), to.y()}, kFloor_m, 0.8};
  }
}

void spoil_depth(DepthErrors& errors, Random& random) {
  errors = DepthErrors::kinect2();
  errors.offset_m = random.uniform(-0.012, 0.012);
  errors.scale = 1 + random.uniform(-0.004, 0.004);
  errors.wiggle_m = random.uniform(0, 0.0025);
  errors.wiggle_period_m = random.uniform(0.6, 1.9);
  errors.wiggle_phase_rad = random.uniform(-kPi, kPi);
}

}  // namespace

FurnishedCell furnish(const Robot& robot, Level level, const CameraParameters& camera, Random& random) {
  FurnishedCell furnished;
  furnished.cell.robot = robot;
  for (auto& link : furnished.cell.robot.links)
    link.surface = {static_cast<float>(random.uniform(0.25, 0.8)),
                    static_cast<float>(random.uniform(0.0, 0.2)),
                    static_cast<std::uint32_t>(random.bits() >> 32)};
  WorldState& state = furnished.state;
  state.joint_count = static_cast<std::int32_t>(robot.positions.size());
  state.sensor_count = 1;
  state.sensors[0].camera = camera;
  state.sensors[0].depth.noise = 1;
  state.sensors[0].infrared = InfraredErrors::kinect2();
  if (level == Level::clean) return furnished;
  add_bench(furnished, random);
  add_room(furnished, random);
  add_company(furnished, random);
  spoil_depth(state.sensors[0].depth, random);
  if (level == Level::field)
    for (std::size_t j = 0; j < robot.positions.size(); ++j)
      state.joint_zero_rad[j] = random.uniform(-1e-3, 1e-3);
  return furnished;
}

}  // namespace calibrd::sim
