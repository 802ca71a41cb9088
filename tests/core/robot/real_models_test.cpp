// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/robot/robot_model.hpp"
#include "tests/core/robot/shared_data.hpp"

namespace calibrd {
namespace {

Eigen::AlignedBox3f bounds(const RobotModel& robot, std::string_view link) {
  Eigen::AlignedBox3f box;
  for (const auto& vertex :
       robot.links()[static_cast<std::size_t>(robot.find_link(link).value())].surface.vertices)
    box.extend(vertex);
  return box;
}

void expect_bounds(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& lower,
                   const Eigen::Vector3f& upper) {
  EXPECT_LT((box.min() - lower).norm(), 1e-6F) << box.min().transpose();
  EXPECT_LT((box.max() - upper).norm(), 1e-6F) << box.max().transpose();
}

// The numbers are those of the file's <float_array>: no unit stated means metres, and its Y_UP is ignored.
TEST(RealModels, ColladaWithoutUnitIsInMetresAndKeepsItsAxes) {
  const auto urdf = test::shared_data() / "models/motoman_sia5d_support/urdf/sia5d.urdf";
  SKIP_WITHOUT(urdf);
  const auto robot = RobotModel::load(urdf);
  ASSERT_TRUE(robot) << robot.error().message();
  expect_bounds(bounds(*robot, "base_link"), {-0.1292F, -0.1075F, 0}, {0.0672F, 0.11F, 0.1795F});
  EXPECT_EQ(robot->position_names(), (std::vector<std::string>{"joint_s", "joint_l", "joint_e", "joint_u",
                                                               "joint_r", "joint_b", "joint_t"}));
}

TEST(RealModels, BinaryStlIsPlacedByItsVisualOrigin) {
  const auto urdf = test::shared_data() / "real/lbr_med7_zed2i/robot.urdf";
  SKIP_WITHOUT(urdf);
  const auto robot = RobotModel::load(urdf);
  ASSERT_TRUE(robot) << robot.error().message();
  const auto box = bounds(*robot, "lbr_link_7");  // the file's z range 1.2276 … 1.266 m, lowered by 1.231 m
  EXPECT_NEAR(box.min().z(), -0.0034F, 1e-5F);
  EXPECT_NEAR(box.max().z(), 0.035F, 1e-5F);
}

}  // namespace
}  // namespace calibrd
