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
  return PoseChecker(cell, scene.camera).check(render_views(1, scene)[0], T_base_sensor, correction);
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
  EXPECT_TRUE(PoseChecker(cell, ideal_kinect2()).check(render_views(1)[0], true_T_base_sensor(), {}).agrees);
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

TEST(CheckPose, DisagreesFiveMillimetresAwayInAnyDirection) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double by_m : {0.005, -0.005}) {
      Pose moved = true_T_base_sensor();
      moved.translation()[axis] += by_m;
      const PoseCheck check = checked(moved, cluttered());
      EXPECT_TRUE(check.enough_evidence);
      EXPECT_FALSE(check.agrees) << check.shift_sigmas;
      EXPECT_NEAR(check.shift_m, 0.005, 0.001);
    }
  }
}

TEST(CheckPose, DisagreesTurnedByTenMilliradians) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    turn[axis] = 0.01;
    Pose turned = true_T_base_sensor();
    turned.linear() = turned.linear() * exp_so3(turn);
    const PoseCheck check = checked(turned, cluttered());
    EXPECT_FALSE(check.agrees) << check.shift_sigmas;
    EXPECT_NEAR(check.turn_rad, 0.01, 0.003);
  }
}

TEST(CheckPose, SomebodyInFrontOfTheRobotIsNoDisagreement) {
  View view = render_views(1)[0];
  VirtualCell cell(test_arm());
  PoseChecker checker(cell, ideal_kinect2());
  for (const bool all : {false, true}) {
    for (int y = 0; y < view.depth.height; ++y)
      for (int x = 0; x < (all ? view.depth.width : view.depth.width / 2); ++x)
        view.depth.raw[view.depth.index(x, y)] = 600;
    const PoseCheck check = checker.check(view, true_T_base_sensor(), {});
    EXPECT_GT(check.hidden_pixels, 200U);
    EXPECT_EQ(check.enough_evidence, !all);
    EXPECT_EQ(check.agrees, !all) << check.agreement << " " << check.shift_sigmas;
  }
}

TEST(CheckPose, APoseThatIsKnownBadlyIsNotTakenForExact) {
  const View view = render_views(1)[0];
  VirtualCell cell(test_arm());
  PoseChecker checker(cell, ideal_kinect2());
  const Pose off = Eigen::Translation3d(0, 0.007, 0) * true_T_base_sensor();
  EXPECT_FALSE(checker.check(view, off, {}).agrees);
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().tail<3>().setConstant(std::pow(0.002, 2));
  EXPECT_TRUE(checker.check(view, off, {}, covariance).agrees);
  const Pose far = Eigen::Translation3d(0, 0.015, 0) * true_T_base_sensor();
  EXPECT_FALSE(checker.check(view, far, {}, covariance).agrees);
}

/// Something 0.6 m away hides the left of the picture up to column `to`, and its halo shortens what is next
/// to it.
View hidden_up_to(View view, int to) {
  for (int y = 0; y < view.depth.height; ++y)
    for (int x = 0; x < std::min(to + 9, view.depth.width); ++x) {
      auto& raw = view.depth.raw[view.depth.index(x, y)];
      raw = x < to ? std::uint16_t{600} : static_cast<std::uint16_t>(std::max(0, raw - 10));
    }
  return view;
}

TEST(CheckPose, ARobotThatIsPartlyHiddenSpeaksByWhatIsWellClearOfTheRim) {
  const View view = render_views(1)[0];
  VirtualCell cell(test_arm());
  PoseChecker checker(cell, ideal_kinect2());
  const Pose off = Eigen::Translation3d(0, 0.008, 0) * true_T_base_sensor();
  int part = 0, most = 0;
  for (int to = 0; to < view.depth.width; to += 16) {
    const View half = hidden_up_to(view, to);
    const PoseCheck right = checker.check(half, true_T_base_sensor(), {}),
                    wrong = checker.check(half, off, {});
    EXPECT_TRUE(right.agrees || !right.enough_evidence) << to << ": " << right.shift_sigmas;
    EXPECT_LT(right.shift_sigmas, 2) << to;
    const double hidden = static_cast<double>(wrong.hidden_pixels) /
                          static_cast<double>(wrong.hidden_pixels + wrong.robot_pixels + 1);
    if (hidden > 0.15 && hidden < 0.45) {
      ++part;
      EXPECT_TRUE(wrong.enough_evidence && !wrong.agrees) << to << ": " << wrong.shift_sigmas;
    }
    if (hidden > 0.55) {
      ++most;
      EXPECT_TRUE(wrong.agrees || !wrong.enough_evidence) << to << ": " << wrong.shift_sigmas;
    }
  }
  EXPECT_GT(part, 0);
  EXPECT_GT(most, 0);
}

TEST(CheckPose, AFenceBeforeTheRobotSpeaksAgainstNoPose) {
  VirtualCell cell(test_arm());
  PoseChecker checker(cell, ideal_kinect2());
  int hidden_much = 0;
  for (const int bar : {2, 4, 6})
    for (const int every : {14, 20}) {
      View view = render_views(1)[0];
      for (int y = 0; y < view.depth.height; ++y)
        for (int x = 0; x < view.depth.width; ++x)
          if (x % every < bar) view.depth.raw[view.depth.index(x, y)] = 600;
      const PoseCheck check = checker.check(view, true_T_base_sensor(), {});
      hidden_much += 5 * check.hidden_pixels > check.robot_pixels ? 1 : 0;
      EXPECT_TRUE(check.agrees || !check.enough_evidence) << bar << " of " << every;
    }
  EXPECT_GT(hidden_much, 0);
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
  EXPECT_FALSE(PoseChecker(cell, ideal_kinect2()).check(view, true_T_base_sensor(), {}).enough_evidence);
}

TEST(CheckPose, SaysNothingOfAHandfulOfPixels) {
  View view = render_views(1)[0];
  std::ranges::fill(view.depth.raw.begin(), view.depth.raw.end() - 160 * 512,
                    std::uint16_t{0});  // the foot is left
  std::ranges::fill(view.depth.raw.end() - 150 * 512, view.depth.raw.end(), std::uint16_t{0});
  VirtualCell cell(test_arm());
  const PoseCheck check = PoseChecker(cell, ideal_kinect2()).check(view, true_T_base_sensor(), {});
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
