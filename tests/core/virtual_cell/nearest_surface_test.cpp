// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/virtual_cell/surface_sampling.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "tests/core/registration/scene.hpp"
#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

/// Distance (m) of a point from the surface of a box about the origin, inside and outside.
double distance_from_box(const Eigen::Vector3d& p, const Eigen::Vector3d& size) {
  const Eigen::Vector3d beyond = p.cwiseAbs() - size / 2;
  if (beyond.maxCoeff() < 0) return -beyond.maxCoeff();
  return beyond.cwiseMax(0).norm();
}

TEST(NearestSurface, IsThatOfTheNearerOfTwoBoxesWhereverTheJointPutsThem) {
  const Eigen::Vector3d base_size(0.4, 0.3, 0.2), arm_size(0.1, 0.6, 0.15);
  const RobotModel robot =
      robot_from(link("base", box_shape(base_size)) + link("arm", box_shape(arm_size, shift(0, 0.3, 0))) +
                 revolute("joint", "base", "arm", "1 0 0", shift(0, 0, 0.5)));
  VirtualCell cell(robot);
  cell.set_joints(std::vector{0.7});
  const int base = robot.find_link("base").value(), arm = robot.find_link("arm").value();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(place(random), place(random), place(random));
    const Eigen::Vector3d in_arm = cell.link_poses()[static_cast<std::size_t>(arm)].inverse() * p;
    const double from_base = distance_from_box(p, base_size);
    const double from_arm = distance_from_box(in_arm - Eigen::Vector3d(0, 0.3, 0), arm_size);
    const auto nearest = cell.nearest_surface(p, kAnywhere);
    ASSERT_TRUE(nearest);
    ASSERT_NEAR(nearest->distance_m, std::min(from_base, from_arm), 1e-5);
    ASSERT_NEAR((nearest->point_base - p).norm(), nearest->distance_m, 1e-5);
    if (std::abs(from_base - from_arm) > 1e-4) {
      ASSERT_EQ(nearest->link, from_base < from_arm ? base : arm);
    }
  }
}

TEST(NearestSurface, IsNothingWhereNoneIsThatNear) {
  const RobotModel robot = robot_from(link("base", box_shape({0.2, 0.2, 0.2})));
  const VirtualCell cell(robot);
  EXPECT_FALSE(cell.nearest_surface({0.6, 0, 0}, 0.49));
  const auto nearest = cell.nearest_surface({0.6, 0, 0}, 0.51);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->distance_m, 0.5, 1e-6);
  EXPECT_NEAR((nearest->point_base - Eigen::Vector3d(0.1, 0, 0)).norm(), 0, 1e-6);
}

TEST(NearestSurface, OfAnArmIsNeverFartherThanTheNearestOfManySamplesOfIt) {
  const RobotModel& arm = test_arm();
  VirtualCell cell(arm);
  const auto joints = postures(1).front();
  cell.set_joints(joints);
  const auto samples = sample_surface(arm, joints, 20000, 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p(place(random), place(random), place(random));
    double sampled = kAnywhere;
    for (const SurfaceSample& sample : samples) sampled = std::min(sampled, (sample.point - p).norm());
    const auto nearest = cell.nearest_surface(p, kAnywhere);
    ASSERT_TRUE(nearest);
    EXPECT_LE(nearest->distance_m, sampled + 1e-6);
    EXPECT_GT(nearest->distance_m, sampled - 0.02);
  }
}

}  // namespace
}  // namespace calibrd
