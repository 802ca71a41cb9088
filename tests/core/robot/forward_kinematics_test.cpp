// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "core/robot/robot_model.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using std::numbers::pi;

// A slide along x that carries an arm turning about z; two fingers follow: b follows the arm, c follows b.
constexpr auto kGripper = R"(<robot name="gripper">
  <link name="rail"/><link name="slide"/><link name="arm"/><link name="b"/><link name="c"/>
  <joint name="travel" type="prismatic"><parent link="rail"/><child link="slide"/><axis xyz="2 0 0"/>
    <limit lower="0" upper="3" effort="0" velocity="1"/></joint>
  <joint name="turn" type="continuous"><parent link="slide"/><child link="arm"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="prismatic"><parent link="arm"/><child link="b"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="0" velocity="1"/>
    <mimic joint="turn" multiplier="2" offset="0.5"/></joint>
  <joint name="a_c" type="prismatic"><parent link="arm"/><child link="c"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="0" velocity="1"/>
    <mimic joint="b" multiplier="-1" offset="0.25"/></joint>
</robot>)";

RobotModel load(const std::string& base_link = {}) {
  const test::ScratchFolder folder;
  auto robot =
      RobotModel::load(folder.write("gripper.urdf", kGripper), {.search_paths = {}, .base_link = base_link});
  if (!robot) throw std::runtime_error(robot.error().message());
  return std::move(*robot);
}

Pose pose_of(const RobotModel& robot, std::string_view link, std::vector<double> positions) {
  return robot.forward_kinematics(positions)[static_cast<std::size_t>(robot.find_link(link).value())];
}

TEST(ForwardKinematics, PositionsAreThoseOfTheJointsThatMoveByThemselves) {
  EXPECT_EQ(load().position_names(), (std::vector<std::string>{"travel", "turn"}));
}

TEST(ForwardKinematics, PrismaticJointTravelsInMetresWhateverTheLengthOfItsAxis) {
  const Pose T_rail_arm = pose_of(load(), "arm", {0.75, pi / 2});
  EXPECT_TRUE(T_rail_arm.translation().isApprox(Eigen::Vector3d(0.75, 0, 1)));
  EXPECT_TRUE((T_rail_arm.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(ForwardKinematics, MimicJointsFollowThroughChains) {
  const auto robot = load();
  // b = 2 · 0.1 + 0.5 = 0.7; c = -0.7 + 0.25 = -0.45, both along the arm's x.
  const Eigen::Vector3d x_arm(std::cos(0.1), std::sin(0.1), 0);
  EXPECT_TRUE(pose_of(robot, "b", {0, 0.1}).translation().isApprox(0.7 * x_arm + Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(pose_of(robot, "c", {0, 0.1}).translation().isApprox(-0.45 * x_arm + Eigen::Vector3d::UnitZ()));
}

TEST(ForwardKinematics, PosesAreExpressedInTheConfiguredBaseLink) {
  const auto robot = load("arm");
  EXPECT_EQ(robot.base_link(), "arm");
  EXPECT_TRUE(pose_of(robot, "arm", {0.75, 0.3}).isApprox(Pose::Identity()));
  EXPECT_TRUE(pose_of(robot, "rail", {0.75, 0.3}).isApprox(pose_of(load(), "arm", {0.75, 0.3}).inverse()));
}

TEST(ForwardKinematics, WrongCountOfPositionsThrows) {
  const auto robot = load();
  EXPECT_THROW(robot.forward_kinematics(std::vector{0.1}), std::invalid_argument);
  std::vector<Pose> too_few(2);
  EXPECT_THROW(robot.forward_kinematics_into(std::vector{0.1, 0.2}, too_few), std::invalid_argument);
}

}  // namespace
}  // namespace calibrd
