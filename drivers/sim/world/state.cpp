// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/state.hpp"

#include <chrono>

namespace calibrd::sim {

PoseValues PoseValues::of(const Eigen::Isometry3d& pose) {
  PoseValues values;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) values.rows[static_cast<std::size_t>(4 * r + c)] = pose.matrix()(r, c);
  return values;
}

Eigen::Isometry3d PoseValues::pose() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose.matrix()(r, c) = rows[static_cast<std::size_t>(4 * r + c)];
  return pose;
}

DepthErrors DepthErrors::kinect2() {
  DepthErrors e;
  e.noise = 1;
  e.correlated = 1;
  e.offset_m = 0.006;
  e.scale = 1.001;
  e.wiggle_m = 0.0015;
  e.flying_mixed = 0.3;
  e.flying_dropped = 0.5;
  e.dropout = 0.002;
  e.grazing_deg = 80;
  e.min_range_m = 0.5;
  e.max_range_m = 4.5;
  return e;
}

InfraredErrors InfraredErrors::kinect2() {
  InfraredErrors e;
  e.noise = 1;
  e.blur_px = 0.4;
  e.texture = 1;
  return e;
}

Joints WorldState::reported_at(std::int64_t now_ns) const {
  Joints q = motion.positions_at(now_ns);
  for (std::size_t j = 0; j < kMaxJoints; ++j) q[j] -= joint_zero_rad[j];
  return q;
}

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace calibrd::sim
