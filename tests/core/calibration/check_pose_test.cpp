// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/check_pose.hpp"

#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

PoseCheck checked(const Pose& T_base_sensor, const SceneSettings& scene,
                  const DepthCorrection& correction = {}) {
  VirtualCell cell(test_arm());
  return check_pose(cell, scene.camera, render_views(1, scene)[0], T_base_sensor, correction);
}

SceneSettings cluttered() {
  SceneSettings scene;
  scene.clutter = true;
  return scene;
}

TEST(CheckPose, AgreesOnTheTruth) {
  const PoseCheck check = checked(true_T_base_sensor(), cluttered());
  EXPECT_TRUE(check.enough_evidence);
  EXPECT_TRUE(check.agrees);
  EXPECT_GT(check.agreement, 0.95);
  EXPECT_NEAR(check.median_residual_m, 0, 0.5e-3);
}

TEST(CheckPose, MovesTheCellToTheViewsJoints) {
  VirtualCell cell(test_arm());
  cell.set_joints(postures(2)[1]);
  EXPECT_TRUE(check_pose(cell, ideal_kinect2(), render_views(1)[0], true_T_base_sensor(), {}).agrees);
}

TEST(CheckPose, DisagreesFourCentimetresAlongTheLineOfSight) {
  for (const double ahead_m : {0.04, -0.04}) {
    const Pose moved = true_T_base_sensor() * Pose(Eigen::Translation3d(0, 0, ahead_m));
    const PoseCheck check = checked(moved, cluttered());
    EXPECT_TRUE(check.enough_evidence);
    EXPECT_FALSE(check.agrees) << check.agreement;
    EXPECT_NEAR(check.median_residual_m, ahead_m, 5e-3);  // the sensor is that much nearer than it believes
  }
}

TEST(CheckPose, DisagreesWhenTheSensorIsTurnedByFourDegrees) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
    Pose turned = true_T_base_sensor();
    turned.linear() = turned.linear() * exp_so3(4 * kDegree * axis);
    const PoseCheck check = checked(turned, cluttered());
    EXPECT_TRUE(check.enough_evidence);
    EXPECT_FALSE(check.agrees) << check.agreement;
  }
}

TEST(CheckPose, TakesTheKnownRangeOffsetIntoAccount) {
  SceneSettings scene = cluttered();
  scene.offset_m = 0.03;
  DepthCorrection known;
  known.offset_m = 0.03;
  EXPECT_FALSE(checked(true_T_base_sensor(), scene).agrees);
  const PoseCheck check = checked(true_T_base_sensor(), scene, known);
  EXPECT_TRUE(check.agrees);
  EXPECT_NEAR(check.median_residual_m, 0, 0.5e-3);
}

TEST(CheckPose, SaysNothingWhenTheRobotIsOutOfView) {
  Pose away = true_T_base_sensor();
  away.linear() = away.linear() * exp_so3({0, 3.1, 0});
  const PoseCheck check = checked(away, cluttered());
  EXPECT_FALSE(check.enough_evidence);
  EXPECT_FALSE(check.agrees);
  EXPECT_EQ(check.robot_pixels, 0U);
}

TEST(CheckPose, SaysNothingOfAnEmptyFrame) {
  View view = render_views(1)[0];
  std::ranges::fill(view.depth.raw, std::uint16_t{0});
  VirtualCell cell(test_arm());
  EXPECT_FALSE(check_pose(cell, ideal_kinect2(), view, true_T_base_sensor(), {}).enough_evidence);
}

TEST(CheckPose, SaysNothingOfAHandfulOfPixels) {
  View view = render_views(1)[0];
  std::ranges::fill(view.depth.raw.begin(), view.depth.raw.end() - 160 * 512,
                    std::uint16_t{0});  // the foot is left
  std::ranges::fill(view.depth.raw.end() - 150 * 512, view.depth.raw.end(), std::uint16_t{0});
  VirtualCell cell(test_arm());
  const PoseCheck check = check_pose(cell, ideal_kinect2(), view, true_T_base_sensor(), {});
  EXPECT_GT(check.robot_pixels, 0U);
  EXPECT_FALSE(check.enough_evidence);
  EXPECT_FALSE(check.agrees);
}

TEST(CheckPose, DisagreesFourCentimetresAcrossTheLineOfSight) {
  for (const double x : {0.04, -0.04}) {
    const Pose moved = true_T_base_sensor() * Pose(Eigen::Translation3d(x, 0, 0));
    EXPECT_FALSE(checked(moved, cluttered()).agrees) << checked(moved, cluttered()).agreement;
  }
}

}  // namespace
}  // namespace calibrd
