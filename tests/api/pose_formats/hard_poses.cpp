// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/pose_formats/hard_poses.hpp"

#include <numbers>
#include <random>

namespace calibrd::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

class Dice {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vector3d vector(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
  /// Uniform over all rotations: a normalized vector of four normal numbers.
  Eigen::Quaterniond rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(engine_), normal(engine_), normal(engine_), normal(engine_))
        .normalized();
  }

 private:
  std::mt19937 engine_{20240611};
};

template <class Rotation>
Isometry3d pose(const Rotation& rotation, const Vector3d& translation_m) {
  return Eigen::Translation3d(translation_m) * Isometry3d(rotation);
}

std::vector<Isometry3d> half_turns(Dice& dice) {
  std::vector<Isometry3d> poses;
  for (int i = 0; i < 27; ++i) {
    const Vector3d axis(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (axis.norm() == 0) continue;
    for (const double angle : {kPi, -kPi, kPi - 1e-9, kPi + 1e-9, kPi - 1e-13, kPi + 1e-13})
      poses.push_back(pose(AngleAxisd(angle, axis.normalized()), dice.vector(2)));
  }
  return poses;
}

std::vector<double> beside(double angle) {
  std::vector<double> angles{angle};
  for (double gap = 1e-3; gap > 5e-16; gap /= 10) angles.insert(angles.end(), {angle - gap, angle + gap});
  return angles;
}

std::vector<Isometry3d> gimbal_locks(Dice& dice) {
  std::vector<Isometry3d> poses;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  for (const double lock : {-kPi / 2, kPi / 2, 0.0, kPi})
    for (const double middle : beside(lock))
      for (const double first : {0.0, kPi / 2, -kPi, dice.between(-kPi, kPi)})
        for (const double third : {0.0, kPi, dice.between(-kPi, kPi)}) {
          const AngleAxisd turn_y(middle, y);
          poses.push_back(pose(AngleAxisd(first, z) * turn_y * AngleAxisd(third, x), dice.vector(2)));
          poses.push_back(pose(AngleAxisd(first, x) * turn_y * AngleAxisd(third, z), dice.vector(2)));
          poses.push_back(pose(AngleAxisd(first, z) * turn_y * AngleAxisd(third, z), dice.vector(2)));
        }
  return poses;
}

}  // namespace

std::vector<Isometry3d> random_poses(int count) {
  Dice dice;
  std::vector<Isometry3d> poses;
  for (int i = 0; i < count; ++i) poses.push_back(pose(dice.rotation(), dice.vector(i % 2 ? 2 : 20)));
  return poses;
}

std::vector<Isometry3d> edge_poses() {
  Dice dice;
  std::vector<Isometry3d> poses{Isometry3d::Identity(), pose(AngleAxisd(1e-9, Vector3d::UnitY()), {0, 0, 0})};
  for (const auto& part : {half_turns(dice), gimbal_locks(dice)})
    poses.insert(poses.end(), part.begin(), part.end());
  return poses;
}

std::vector<Isometry3d> all_poses() {
  auto poses = random_poses(300);
  const auto edges = edge_poses();
  poses.insert(poses.end(), edges.begin(), edges.end());
  return poses;
}

}  // namespace calibrd::test
