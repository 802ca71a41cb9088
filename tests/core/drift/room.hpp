// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <random>
#include <vector>

#include "core/drift/background_map.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd::test {

/// An axis-parallel box, base frame, m.
struct Block {
  Eigen::Vector3d middle, size;
};

/// A room of blocks around the test arm, seen by a time-of-flight sensor. Only the pixels that the watch of
/// the background looks at are drawn.
class Room {
 public:
  /// Floor, three walls, a table under the arm, things on it.
  static Room furnished();
  /// Nothing but a wall 2 m ahead of true_T_base_sensor(), square to its line of sight.
  static Room single_wall();

  std::vector<Block> blocks;
  double offset_m = 0;  ///< of the range
  double noise_sigma_m = 0.0015;
  bool has_arm = true;
  double hidden_share = 0;  ///< of the picture, from its left, by something 0.6 m ahead

  View seen_from(const Pose& T_base_sensor, const std::vector<double>& joints, double stamp_s = 0);

  static const CameraModel& camera();

 private:
  double depth_of_blocks(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray_base) const;

  Pose T_room_base_ = Pose::Identity();
  std::mt19937_64 random_{7};
};

/// A map learnt from `count` views of different postures, from true_T_base_sensor().
BackgroundMap learnt(Room& room, std::size_t count = 6);
/// The arm's mask at `joints`, or nothing hidden where the room has no arm.
std::vector<std::uint8_t> mask_of(const Room& room, const std::vector<double>& joints);

}  // namespace calibrd::test
