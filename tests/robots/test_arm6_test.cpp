// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "core/robot/robot_model.hpp"
#include "drivers/sim/model/robot_file.hpp"

namespace calibrd {
namespace {

TEST(TestArm6, IsASixAxisArmToCore) {
  const auto robot = RobotModel::load(CALIBRD_TEST_ARM6_URDF);
  ASSERT_TRUE(robot) << robot.error().message();
  EXPECT_EQ(robot->position_count(), 6U);
  ASSERT_EQ(robot->links().size(), 7U);
  for (const Link& link : robot->links()) EXPECT_GT(link.surface.triangles.size(), 100U) << link.name;
}

TEST(TestArm6, IsASixAxisArmToTheSimulator) {
  const auto robot = sim::read_robot(CALIBRD_TEST_ARM6_URDF, {});
  ASSERT_TRUE(robot) << robot.error().message();
  EXPECT_EQ(robot->positions.size(), 6U);
}

/// Area of the closed surface's shadow side minus its lit side is 0, and its volume is positive when its
/// triangles face outward.
TEST(TestArm6, EveryLinkIsClosedAndFacesOutward) {
  const auto robot = RobotModel::load(CALIBRD_TEST_ARM6_URDF);
  ASSERT_TRUE(robot);
  for (const Link& link : robot->links()) {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    double volume = 0;
    for (const auto& [a, b, c] : link.surface.triangles) {
      const Eigen::Vector3d p = link.surface.vertices[a].cast<double>(),
                            q = link.surface.vertices[b].cast<double>(),
                            r = link.surface.vertices[c].cast<double>();
      area += 0.5 * (q - p).cross(r - p);
      volume += p.dot(q.cross(r)) / 6;
    }
    EXPECT_LT(area.norm(), 1e-6) << link.name;
    EXPECT_GT(volume, 1e-4) << link.name;
  }
}

TEST(TestArm6, LastAxisMissesTheFourth) {
  const auto robot = RobotModel::load(CALIBRD_TEST_ARM6_URDF);
  ASSERT_TRUE(robot);
  const auto poses = robot->forward_kinematics(std::vector<double>(6, 0.0));
  const Eigen::Vector3d from = poses[static_cast<std::size_t>(*robot->find_link("forearm"))].translation(),
                        to = poses[static_cast<std::size_t>(*robot->find_link("tool"))].translation();
  EXPECT_NEAR((to - from).y(), -0.042, 1e-9);  // both axes point along x
}

}  // namespace
}  // namespace calibrd
