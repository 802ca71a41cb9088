// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/random.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// Tells whether the moving links stay clear of the objects of a cell, by the links' vertices.
class Clearance {
 public:
  Clearance(const Cell& cell, std::span<const ObjectState> objects);

  bool is_free(const Joints& joints) const;
  /// Also between the two, on a straight line in joint space.
  bool is_free_between(const Joints& from, const Joints& to) const;

 private:
  struct Block {
    Eigen::Isometry3d T_block_base;
    Eigen::Vector3d half_size;  // with margin
    Eigen::Vector3d centre;     // object frame
  };
  bool touches(const Eigen::Vector3d& point_base) const;

  const Robot& robot_;
  std::vector<std::vector<Eigen::Vector3d>> link_points_;  // empty for links that no joint moves
  std::vector<Block> blocks_;
};

/// Within the middle of the joint ranges; may touch anything.
Joints random_posture(const Robot& robot, Random& random);

/// `count` postures within the joint limits, clear of the objects, each reachable from the one before (and
/// the first from `start` and from the last). The same for the same `random`. Errors: no_free_posture.
Result<std::vector<Joints>> random_postures(const Cell& cell, std::span<const ObjectState> objects,
                                            Random& random, std::size_t count, const Joints& start);

}  // namespace calibrd::sim
