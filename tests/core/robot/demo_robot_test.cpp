// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "core/robot/robot_model.hpp"
#include "tests/core/robot/mesh_checks.hpp"
#include "tests/core/robot/shared_data.hpp"

namespace calibrd {
namespace {

RobotModel load_demo_arm() {
  auto robot = RobotModel::load(CALIBRD_DEMO_URDF);
  if (!robot) throw std::runtime_error(robot.error().message());
  return std::move(*robot);
}

TEST(DemoRobot, HousingsAreClosedOutwardAndOfUsableSize) {
  const auto robot = load_demo_arm();
  for (const Link& link : robot.links()) {
    if (link.name == "tool0" || link.name == "base") continue;
    EXPECT_TRUE(test::is_closed(link.surface)) << link.name;
    EXPECT_GT(test::volume(link.surface), 0) << link.name;
    EXPECT_GE(link.surface.triangles.size(), 1000U) << link.name;
    EXPECT_LE(link.surface.triangles.size(), 5000U) << link.name;
    EXPECT_LT(test::bounds(link.surface).diagonal().norm(), 0.5F) << link.name;
  }
}

TEST(DemoRobot, NeighboursOverlapAtTheirJoint) {
  const auto robot = load_demo_arm();
  const auto T_base_link = robot.forward_kinematics(std::vector<double>(7, 0.0));
  const auto box_at_zero = [&](int link) {
    Eigen::AlignedBox3d box;
    for (const auto& vertex : robot.links()[static_cast<std::size_t>(link)].surface.vertices)
      box.extend(T_base_link[static_cast<std::size_t>(link)] * vertex.cast<double>());
    return box;
  };
  for (const Joint& joint : robot.joints()) {
    if (joint.type == JointType::fixed) continue;
    EXPECT_TRUE(box_at_zero(joint.parent_link).intersects(box_at_zero(joint.child_link))) << joint.name;
  }
}

TEST(DemoRobot, LinkFramesAreThoseOfTheSia5d) {
  const auto urdf = test::shared_data() / "models/motoman_sia5d_support/urdf/sia5d.urdf";
  SKIP_WITHOUT(urdf);
  const auto sia5d = RobotModel::load(urdf);
  ASSERT_TRUE(sia5d) << sia5d.error().message();
  const auto demo = load_demo_arm();
  const std::vector<double> positions{0.4, -0.3, 0.9, 1.1, -0.7, 0.6, 0.2};
  const auto T_base_demo = demo.forward_kinematics(positions),
             T_base_sia5d = sia5d->forward_kinematics(positions);
  ASSERT_EQ(demo.position_names(), sia5d->position_names());
  for (const char* joint : {"joint_s", "joint_l", "joint_e", "joint_u", "joint_r", "joint_b", "joint_t"}) {
    const auto child = [joint](const RobotModel& robot) {
      const auto found = std::ranges::find(robot.joints(), joint, &Joint::name);
      return static_cast<std::size_t>(found->child_link);
    };
    EXPECT_TRUE(T_base_demo[child(demo)].isApprox(T_base_sia5d[child(*sia5d)], 1e-12)) << joint;
  }
}

}  // namespace
}  // namespace calibrd
