// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/bodies.hpp"

#include "drivers/sim/world/person.hpp"

namespace calibrd::sim {
namespace {

constexpr Surface kClothes{0.35F, 0.3F, 9000};

void add_robot(const Robot& robot, const Joints& joints, const Eigen::Isometry3d& T_base_robot, bool is_robot,
               std::vector<Body>& bodies) {
  const auto poses = robot.link_poses(joints);
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    if (!robot.links[l].mesh.triangles.empty())
      bodies.push_back({&robot.links[l].mesh, robot.links[l].surface, T_base_robot * poses[l], is_robot});
}

}  // namespace

std::vector<Body> standing_bodies(const Cell& cell, const WorldState& state) {
  std::vector<Body> bodies;
  for (std::size_t o = 0; o < cell.objects.size(); ++o)
    if (state.objects[o].present != 0)
      bodies.push_back({&cell.objects[o].mesh, cell.objects[o].surface, state.objects[o].T_base_object.pose(), false});
  if (state.other_robot.present != 0)
    add_robot(cell.robot, state.other_robot.joints, state.other_robot.T_base_other.pose(), false, bodies);
  return bodies;
}

std::vector<Body> moving_bodies(const Cell& cell, const std::vector<Mesh>& person, const WorldState& state,
                                std::int64_t now_ns) {
  std::vector<Body> bodies;
  add_robot(cell.robot, state.motion.positions_at(now_ns), Eigen::Isometry3d::Identity(), true, bodies);
  if (state.person.present == 0) return bodies;
  const auto poses = person_poses(state.person, now_ns);
  for (std::size_t i = 0; i < person.size(); ++i) bodies.push_back({&person[i], kClothes, poses[i], false});
  return bodies;
}

}  // namespace calibrd::sim
