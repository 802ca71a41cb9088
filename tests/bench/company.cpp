// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/company.hpp"

#include <algorithm>

#include "drivers/sim/world/person.hpp"

namespace calibrd::bench {
namespace {

/// Where what is not there is drawn: out of everybody's sight.
const Eigen::Vector3d kNowhere(0, 0, -200);
constexpr float kClothes = 0.35F, kCardboard = 0.6F;

std::size_t last_body(const sim::Robot& robot) {
  std::size_t last = 0;
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    if (!robot.links[l].mesh.vertices.empty()) last = l;
  return last;
}

}  // namespace

Company::Company(sim::Cell& cell, sim::Random& random)
    : cell_(cell), flange_(last_body(cell.robot)), people_(kPeople) {
  first_person_ = cell.robot.links.size();
  for (std::size_t person = 0; person < kPeople; ++person)
    for (auto& mesh : sim::person_parts()) add(std::move(mesh), kClothes);
  part_ = add(sim::make_box({1, 1, 1}), kCardboard);
  grip_ = Eigen::Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
}

std::size_t Company::add(sim::Mesh mesh, float albedo) {
  sim::Robot& robot = cell_.robot;
  sim::RobotJoint joint;
  joint.parent_link = robot.base_link;
  joint.child_link = static_cast<int>(robot.links.size());
  joint.T_parent_joint.translation() = kNowhere;
  robot.links.push_back(
      {"company", static_cast<int>(robot.joints.size()), std::move(mesh), {albedo, 0.2F, 77}});
  robot.joints.push_back(joint);
  return robot.links.size() - 1;
}

void Company::place(std::size_t link, const Eigen::Isometry3d& T_base_body) {
  cell_.robot.joints[static_cast<std::size_t>(cell_.robot.links[link].parent_joint)].T_parent_joint =
      T_base_body;
}

void Company::carry(const std::optional<Eigen::Vector3d>& size_m) {
  carries_ = size_m.has_value();
  if (size_m) cell_.robot.links[part_].mesh = sim::make_box(*size_m);
}

void Company::move(const sim::Joints& joints, std::int64_t now_ns) {
  const Eigen::Isometry3d nowhere(Eigen::Translation3d{kNowhere});
  for (std::size_t p = 0; p < kPeople; ++p) {
    const auto poses = sim::person_poses(people_[p], now_ns);
    for (std::size_t i = 0; i < poses.size(); ++i)
      place(first_person_ + p * poses.size() + i, people_[p].present != 0 ? poses[i] : nowhere);
  }
  if (!carries_) return place(part_, nowhere);
  const auto& link = cell_.robot.links[flange_].mesh;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& vertex : link.vertices) middle += vertex.cast<double>();
  middle /= static_cast<double>(link.vertices.size());
  const auto& part = cell_.robot.links[part_].mesh;
  const Eigen::Vector3d size =
      2 *
      std::ranges::max_element(part.vertices, {}, &Eigen::Vector3f::squaredNorm)->cast<double>().cwiseAbs();
  place(part_,
        cell_.robot.link_poses(joints)[flange_] * Eigen::Translation3d(middle + grip_.cwiseProduct(size)));
}

}  // namespace calibrd::bench
