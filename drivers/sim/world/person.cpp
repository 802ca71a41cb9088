// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/person.hpp"

#include <cmath>
#include <numbers>

namespace calibrd::sim {
namespace {

constexpr double kStride_Hz = 0.9;
constexpr double kSwing_rad = 0.45;
constexpr double kHip_m = 0.92;
constexpr double kShoulder_m = 1.42;

struct Limb {
  double height_m;  // of the joint it swings about
  double sideways_m;
  double radius_m, length_m;
  double swing;  // sign and size of its swing
};

constexpr Limb kLimbs[] = {{kHip_m, 0.10, 0.075, 0.76, 1.0},
                           {kHip_m, -0.10, 0.075, 0.76, -1.0},
                           {kShoulder_m, 0.23, 0.05, 0.55, -0.7},
                           {kShoulder_m, -0.23, 0.05, 0.55, 0.7}};

/// Walker's frame (x ahead, z up, origin between the feet) at a time.
Eigen::Isometry3d walker(const PersonState& person, double t_s) {
  const Eigen::Vector2d from(person.from_m.data()), to(person.to_m.data());
  const double length = std::max((to - from).norm(), 1e-6);
  const double way = std::fmod(person.speed_m_s * t_s, 2 * length);
  const bool back = way > length;
  const Eigen::Vector2d ahead = (to - from) / length * (back ? -1 : 1);
  const Eigen::Vector2d place = from + (to - from) / length * (back ? 2 * length - way : way);
  Eigen::Isometry3d T_base_walker = Eigen::Isometry3d::Identity();
  T_base_walker.translation() << place, person.floor_z_m;
  T_base_walker.linear() =
      Eigen::AngleAxisd(std::atan2(ahead.y(), ahead.x()), Eigen::Vector3d::UnitZ()).matrix();
  return T_base_walker;
}

}  // namespace

std::vector<Mesh> person_parts() {
  std::vector<Mesh> parts{make_capsule(0.17, 0.40), make_capsule(0.10, 0.10)};
  for (const Limb& limb : kLimbs) parts.push_back(make_capsule(limb.radius_m, limb.length_m));
  return parts;
}

std::vector<Eigen::Isometry3d> person_poses(const PersonState& person, std::int64_t now_ns) {
  const double t_s = static_cast<double>(now_ns - person.since_ns) * 1e-9;
  const Eigen::Isometry3d T_base_walker = walker(person, t_s);
  std::vector<Eigen::Isometry3d> poses{T_base_walker * Eigen::Translation3d(0, 0, 1.20),
                                       T_base_walker * Eigen::Translation3d(0, 0, 1.62)};
  for (const Limb& limb : kLimbs) {
    const double angle = kSwing_rad * limb.swing * std::sin(2 * std::numbers::pi * kStride_Hz * t_s);
    poses.push_back(T_base_walker * Eigen::Translation3d(0, limb.sideways_m, limb.height_m) *
                    Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
                    Eigen::Translation3d(0, 0, -0.5 * limb.length_m));
  }
  return poses;
}

}  // namespace calibrd::sim
