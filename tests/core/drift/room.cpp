// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/drift/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calibrd::test {
namespace {

constexpr double kScale_m = 0.001;

/// How far along the ray the block begins; infinite when it is missed.
double distance_to(const Block& block, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double a = (block.middle[i] - 0.5 * block.size[i] - origin[i]) / ray[i],
                 b = (block.middle[i] + 0.5 * block.size[i] - origin[i]) / ray[i];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near > 0 && near <= far ? near : std::numeric_limits<double>::infinity();
}

}  // namespace

const CameraModel& Room::camera() {
  static const CameraModel camera = ideal_kinect2();
  return camera;
}

Room Room::furnished() {
  Room room;
  room.blocks = {{{0, 0, -0.85}, {9, 9, 0.1}},          {{2.6, 0, 1}, {0.1, 9, 5}},
                 {{-2.6, 0, 1}, {0.1, 9, 5}},           {{0, 2.6, 1}, {9, 0.1, 5}},
                 {{0, -2.6, 1}, {9, 0.1, 5}},           {{0, 0, -0.05}, {1.4, 1.4, 0.1}},
                 {{0.45, 0.4, 0.15}, {0.3, 0.25, 0.3}}, {{-0.45, 0.5, 0.1}, {0.2, 0.3, 0.2}},
                 {{0.4, -0.5, 0.1}, {0.25, 0.25, 0.2}}};
  return room;
}

Room Room::single_wall() {
  Room room;
  room.has_arm = false;
  room.T_room_base_ = true_T_base_sensor().inverse();
  room.blocks = {{{0, 0, 2.05}, {20, 20, 0.1}}};
  return room;
}

double Room::depth_of_blocks(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray_base) const {
  double nearest = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d from = T_room_base_ * origin, along = T_room_base_.linear() * ray_base;
  for (const Block& block : blocks) nearest = std::min(nearest, distance_to(block, from, along));
  return std::isfinite(nearest) ? nearest : 0;
}

View Room::seen_from(const Pose& T_base_sensor, const std::vector<double>& joints, double stamp_s) {
  const CameraModel grid = camera().subsampled(kBackgroundStride);
  VirtualMeasurement arm;
  if (has_arm) {
    VirtualCell cell(test_arm());
    cell.set_joints(joints);
    cell.measure(grid, T_base_sensor, arm);
  }
  View view;
  view.joint_positions_rad = joints;
  view.stamp_s = stamp_s;
  view.depth = {camera().width, camera().height, kScale_m, {}};
  view.depth.raw.resize(static_cast<std::size_t>(camera().width) * static_cast<std::size_t>(camera().height));
  std::normal_distribution<double> noise(0, 1);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      double z = depth_of_blocks(T_base_sensor.translation(), T_base_sensor.linear() * grid.ray(x, y));
      if (has_arm) {
        const double of_arm = arm.depth_m[arm.index(x, y)];
        if (of_arm > 0 && (z <= 0 || of_arm < z)) z = of_arm;
      }
      if (x < hidden_share * grid.width) z = 0.6;
      if (z > 0) z += offset_m + noise_sigma_m * noise(random_);
      view.depth.raw[view.depth.index(kBackgroundStride * x, kBackgroundStride * y)] =
          static_cast<std::uint16_t>(std::lround(std::max(0.0, z) / kScale_m));
    }
  }
  return view;
}

std::vector<std::uint8_t> mask_of(const Room& room, const std::vector<double>& joints) {
  const CameraModel grid = Room::camera().subsampled(kBackgroundStride);
  if (!room.has_arm)
    return std::vector<std::uint8_t>(static_cast<std::size_t>(grid.width) *
                                     static_cast<std::size_t>(grid.height));
  const VirtualCell cell(test_arm());
  return RobotMask(cell, Room::camera()).at(joints, true_T_base_sensor());
}

BackgroundMap learnt(Room& room, std::size_t count) {
  std::vector<View> views;
  std::vector<std::vector<std::uint8_t>> masks;
  for (const auto& joints : postures(count)) {
    views.push_back(room.seen_from(true_T_base_sensor(), joints));
    masks.push_back(mask_of(room, joints));
  }
  BackgroundMap map(Room::camera());
  map.learn(views, masks);
  return map;
}

}  // namespace calibrd::test
