// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/postures.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

constexpr double kMargin_m = 0.03;
constexpr std::size_t kPointsPerLink = 150;
constexpr double kPathStep_rad = 0.15;
constexpr double kUsedRange = 0.75;  // part of a joint's range that postures are drawn from
constexpr double kWidest_rad = 1.5;
constexpr int kTries = 4000;

bool is_moved(const Robot& robot, std::size_t link) {
  for (int joint = robot.links[link].parent_joint; joint >= 0;) {
    const RobotJoint& above = robot.joints[static_cast<std::size_t>(joint)];
    if (above.movement != Movement::fixed) return true;
    joint = robot.links[static_cast<std::size_t>(above.parent_link)].parent_joint;
  }
  return false;
}

}  // namespace

Joints random_posture(const Robot& robot, Random& random) {
  Joints q{};
  for (std::size_t j = 0; j < robot.positions.size(); ++j) {
    const auto& range = robot.positions[j];
    const double middle = 0.5 * (range.lower + range.upper);
    const double half = std::min(0.5 * kUsedRange * (range.upper - range.lower), kWidest_rad);
    q[j] = random.uniform(middle - half, middle + half);
  }
  return q;
}

Clearance::Clearance(const Cell& cell, std::span<const ObjectState> objects) : robot_(cell.robot) {
  for (std::size_t l = 0; l < robot_.links.size(); ++l) {
    auto& points = link_points_.emplace_back();
    if (!is_moved(robot_, l)) continue;
    const auto& vertices = robot_.links[l].mesh.vertices;
    const std::size_t step = std::max<std::size_t>(1, vertices.size() / kPointsPerLink);
    for (std::size_t v = 0; v < vertices.size(); v += step) points.push_back(vertices[v].cast<double>());
  }
  for (std::size_t o = 0; o < cell.objects.size(); ++o) {
    if (objects[o].present == 0 || cell.objects[o].mesh.vertices.empty()) continue;
    Eigen::AlignedBox3d bounds;
    for (const auto& vertex : cell.objects[o].mesh.vertices) bounds.extend(vertex.cast<double>().eval());
    blocks_.push_back({objects[o].T_base_object.pose().inverse(),
                       0.5 * bounds.sizes() + Eigen::Vector3d::Constant(kMargin_m), bounds.center()});
  }
}

bool Clearance::touches(const Eigen::Vector3d& point_base) const {
  return std::any_of(blocks_.begin(), blocks_.end(), [&](const Block& block) {
    const Eigen::Vector3d inside = (block.T_block_base * point_base - block.centre).cwiseAbs();
    return (inside.array() < block.half_size.array()).all();
  });
}

bool Clearance::is_free(const Joints& joints) const {
  const auto poses = robot_.link_poses(joints);
  for (std::size_t l = 0; l < poses.size(); ++l)
    for (const auto& point : link_points_[l])
      if (touches(poses[l] * point)) return false;
  return true;
}

bool Clearance::is_free_between(const Joints& from, const Joints& to) const {
  double farthest = 0;
  for (std::size_t j = 0; j < kMaxJoints; ++j) farthest = std::max(farthest, std::abs(to[j] - from[j]));
  const int steps = static_cast<int>(std::ceil(farthest / kPathStep_rad));
  for (int i = 1; i < steps; ++i) {
    Joints q;
    for (std::size_t j = 0; j < kMaxJoints; ++j) q[j] = from[j] + (to[j] - from[j]) * i / steps;
    if (!is_free(q)) return false;
  }
  return true;
}

Result<std::vector<Joints>> random_postures(const Cell& cell, std::span<const ObjectState> objects,
                                            Random& random, std::size_t count, const Joints& start) {
  const Clearance clearance(cell, objects);
  std::vector<Joints> postures;
  for (int i = 0; i < kTries && postures.size() < count; ++i) {
    const Joints q = random_posture(cell.robot, random);
    const Joints& before = postures.empty() ? start : postures.back();
    if (!clearance.is_free(q) || !clearance.is_free_between(before, q)) continue;
    if (postures.size() + 1 == count && count > 1 && !clearance.is_free_between(q, postures.front()))
      continue;
    postures.push_back(q);
  }
  if (postures.size() < count) return sim_error(SimError::no_free_posture, cell.robot.name);
  return postures;
}

}  // namespace calibrd::sim
