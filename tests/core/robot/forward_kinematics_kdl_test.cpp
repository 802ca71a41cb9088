// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "core/robot/robot_model.hpp"
#include "tests/core/robot/kdl_oracle.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/core/robot/shared_data.hpp"

namespace calibrd {
namespace {

constexpr int kPostures = 1000;
constexpr double kTolerance = 1e-9;  // m, and entries of the rotation matrix

// Every type of joint, skew origins, axes of other lengths than one, a branch.
constexpr auto kSkewRobot = R"(<robot name="skew">
  <link name="root"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="tip"/><link name="side"/>
  <joint name="j1" type="revolute"><parent link="root"/><child link="a"/><origin xyz="0.1 -0.2 0.3" rpy="0.3 -1.2 2.9"/>
    <axis xyz="1 2 -3"/><limit lower="-3" upper="3" effort="0" velocity="1"/></joint>
  <joint name="j2" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0 0.4 0" rpy="1.5707963267948966 0 0.1"/>
    <axis xyz="0 0.5 0.5"/><limit lower="-1" upper="1" effort="0" velocity="1"/></joint>
  <joint name="j3" type="continuous"><parent link="b"/><child link="c"/><origin xyz="-0.7 0 0.2" rpy="0 1.5707963267948966 0"/>
    <axis xyz="-4 0.01 0"/></joint>
  <joint name="j4" type="fixed"><parent link="c"/><child link="d"/><origin xyz="1 2 3" rpy="-0.5 0.4 0.3"/></joint>
  <joint name="j5" type="continuous"><parent link="d"/><child link="tip"/><axis xyz="0 0 1"/></joint>
  <joint name="j0" type="continuous"><parent link="a"/><child link="side"/><origin xyz="0 0 1"/><axis xyz="0 -1 0"/></joint>
</robot>)";

void expect_same_as_kdl(const std::filesystem::path& urdf) {
  const auto robot = RobotModel::load(urdf);
  ASSERT_TRUE(robot) << robot.error().message();
  const test::KdlOracle oracle(urdf);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  double worst = 0;
  for (int posture = 0; posture < kPostures; ++posture) {
    std::vector<double> positions;
    std::map<std::string, double> by_name;
    for (const auto& name : robot->position_names()) by_name[name] = positions.emplace_back(angle(random));
    const auto T_root_link = robot->forward_kinematics(positions);
    const auto expected = oracle.link_poses(by_name);
    ASSERT_EQ(T_root_link.size(), expected.size());
    for (std::size_t link = 0; link < T_root_link.size(); ++link) {
      const Pose& pose = expected.at(robot->links()[link].name);
      worst = std::max(worst, (T_root_link[link].matrix() - pose.matrix()).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(worst, kTolerance);
  ::testing::Test::RecordProperty("worst_difference", std::to_string(worst * 1e15) + "e-15");
}

TEST(ForwardKinematics, OfTheDemoArmEqualsKdl) { expect_same_as_kdl(CALIBRD_DEMO_URDF); }

TEST(ForwardKinematics, OfSkewAxesAndEveryJointTypeEqualsKdl) {
  const test::ScratchFolder folder;
  expect_same_as_kdl(folder.write("skew.urdf", kSkewRobot));
}

TEST(ForwardKinematics, OfTheSia5dEqualsKdl) {
  const auto urdf = test::shared_data() / "models/motoman_sia5d_support/urdf/sia5d.urdf";
  SKIP_WITHOUT(urdf);
  expect_same_as_kdl(urdf);
}

TEST(ForwardKinematics, OfTheLbrMed7EqualsKdl) {
  const auto urdf = test::shared_data() / "real/lbr_med7_zed2i/robot.urdf";
  SKIP_WITHOUT(urdf);
  expect_same_as_kdl(urdf);
}

}  // namespace
}  // namespace calibrd
