// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/controller_frame.hpp"

#include <gtest/gtest.h>

#include "core/robot/robot_model.hpp"
#include "core/robot/robot_model_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

// A track carries a pedestal; on it the arm, and beside it the controller's base..
constexpr auto kOnATrack = R"(<robot name="on_a_track">
  <link name="floor"/><link name="carriage"/><link name="base_link"/><link name="arm"/><link name="base"/><link name="finger"/>
  <joint name="track" type="prismatic"><parent link="floor"/><child link="carriage"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="3" effort="0" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="carriage"/><child link="base_link"/><origin xyz="0 0 0.5"/></joint>
  <joint name="turn" type="continuous"><parent link="base_link"/><child link="arm"/><axis xyz="0 0 1"/></joint>
  <joint name="base_link_base" type="fixed"><parent link="carriage"/><child link="base"/>
    <origin xyz="0.1 0.2 0.81" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="grip" type="prismatic"><parent link="base_link"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="-9" upper="9" effort="0" velocity="1"/><mimic joint="turn"/></joint>
</robot>)";

RobotModel load(const std::string& base_link) {
  const test::ScratchFolder folder;
  auto model =
      RobotModel::load(folder.write("r.urdf", kOnATrack), {.search_paths = {}, .base_link = base_link});
  if (!model) throw std::runtime_error(model.error().message());
  return *std::move(model);
}

TEST(ControllerFrame, IsPlacedAgainstTheBaseLinkByFixedJoints) {
  const auto frame = find_controller_frame(load("base_link"), "base");
  ASSERT_TRUE(frame) << frame.error().message();
  EXPECT_EQ(frame->link, "base");
  const Eigen::Vector3d point = frame->T_base_controller * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((point - Eigen::Vector3d(0.1, 1.2, 0.31)).norm(), 1e-12) << point.transpose();
}

TEST(ControllerFrame, MayBeTheBaseLinkItselfAndALinkAboveIt) {
  const auto same = find_controller_frame(load("arm"), "arm");
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->T_base_controller.isApprox(Pose::Identity()));
  const auto above = find_controller_frame(load("base_link"), "carriage");
  ASSERT_TRUE(above) << above.error().message();
  EXPECT_DOUBLE_EQ(above->T_base_controller.translation().z(), -0.5);
}

void expect_moves(const std::string& base_link, const std::string& link, const std::string& by) {
  const auto frame = find_controller_frame(load(base_link), link);
  ASSERT_FALSE(frame) << base_link << " " << link;
  EXPECT_EQ(frame.error().code, RobotModelError::link_moves);
  for (const auto& word : {base_link, link, by})
    EXPECT_NE(frame.error().message().find("'" + word + "'"), std::string::npos) << frame.error().message();
}

TEST(ControllerFrame, ThatAJointMovesIsRefusedAndTheJointNamed) {
  expect_moves("base_link", "arm", "turn");
  expect_moves("arm", "base", "turn");
  expect_moves("base_link", "floor", "track");
  expect_moves("base_link", "finger", "grip");
}

TEST(ControllerFrame, ThatIsNoLinkIsRefusedWithTheNearestName) {
  const auto frame = find_controller_frame(load("base_link"), "bse");
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, RobotModelError::unknown_link);
  EXPECT_NE(frame.error().message().find("did you mean 'base'?"), std::string::npos)
      << frame.error().message();
}

}  // namespace
}  // namespace calibrd
