// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/observability.hpp"

#include "core/calibration/verdict.hpp"
#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

const Eigen::Vector3d kRobot = true_T_base_sensor() * Eigen::Vector3d(0, 0, 1.4);

/// Covariance of a sensor that is held in every direction but one: `delta` is one standard deviation of it.
Matrix6d loose_along(const Vector6d& delta) {
  return 1e-10 * Matrix6d::Identity() + delta * delta.transpose();
}

std::vector<WeakDirection> weak(const Matrix6d& covariance) {
  return weak_directions(covariance, true_T_base_sensor(), kRobot, {});
}

TEST(Observability, HeldSensorHasNoWeakDirection) { EXPECT_TRUE(weak(1e-8 * Matrix6d::Identity()).empty()); }

TEST(Observability, NamesTheLineOfSight) {
  Vector6d delta = Vector6d::Zero();
  delta.tail<3>() = 0.01 * true_T_base_sensor().linear().col(2);
  const auto directions = weak(loose_along(delta));
  ASSERT_EQ(directions.size(), 1U);
  EXPECT_EQ(directions[0].what, "along the line of sight");
  EXPECT_FALSE(directions[0].is_rotation);
  EXPECT_NEAR(directions[0].sigma, 0.01, 1e-6);
  EXPECT_GT(std::abs(directions[0].direction_base.dot(true_T_base_sensor().linear().col(2))), 0.999);
}

TEST(Observability, SwingAboutTheRobotIsARotationAndNoShift) {
  Vector6d delta;
  delta.head<3>() = Eigen::Vector3d(0, 0, 0.01);
  delta.tail<3>() = delta.head<3>().cross(true_T_base_sensor().translation() - kRobot);
  const auto directions = weak(loose_along(delta));
  ASSERT_EQ(directions.size(), 1U);
  EXPECT_EQ(directions[0].what, "about the vertical axis of the robot");
  EXPECT_TRUE(directions[0].is_rotation);
  EXPECT_NEAR(directions[0].sigma, 0.01, 1e-6);
}

TEST(Observability, ReasonOfAnUncertainResultNamesTheDirection) {
  Refinement r;
  r.T_base_sensor = true_T_base_sensor();
  r.range.predicted = r.range.measured = r.range.agreeing = 10000;
  Vector6d delta = Vector6d::Zero();
  delta.tail<3>() = 0.01 * true_T_base_sensor().linear().col(2);
  r.covariance = loose_along(delta);
  Evidence evidence;
  evidence.robot_middle_base = kRobot;
  CalibrationResult result;
  judge(r, evidence, {}, result);
  ASSERT_EQ(result.verdict, Verdict::uncertain);
  ASSERT_EQ(result.reasons.size(), 1U);
  EXPECT_NE(result.reasons[0].text.find("along the line of sight"), std::string::npos)
      << result.reasons[0].text;
}

TEST(Workspace, ErrorGrowsWithTheDistanceFromTheSensor) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = 1e-6 * Eigen::Matrix3d::Identity();  // 1 mrad about each axis
  const Pose T_base_sensor = true_T_base_sensor();
  const auto errors = workspace_errors(covariance, T_base_sensor,
                                       {{"at the sensor", T_base_sensor.translation()},
                                        {"a metre ahead", T_base_sensor * Eigen::Vector3d(0, 0, 1)}});
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_NEAR(errors[0].sigma_m, 0, 1e-12);
  EXPECT_NEAR(errors[1].sigma_m, std::sqrt(2.0) * 1e-3, 1e-9);  // two axes turn it, one does not
  EXPECT_EQ(errors[1].point.name, "a metre ahead");
}

TEST(Workspace, ErrorOfAPointIsCoveredByItsPrediction) {
  SceneSettings scene;
  scene.images = true;
  CalibrationSettings settings = from_guess(rough_guess());
  settings.workspace = {{"tray", {0.5, 0.2, 0.1}}, {"far", {1.0, -1.0, 0.5}}};
  const auto result = calibrate(test_arm(), scene.camera, render_views(3, scene), settings);
  ASSERT_EQ(result.workspace.size(), 2U) << described(result);
  for (const WorkspaceError& error : result.workspace) {
    const Eigen::Vector3d seen = true_T_base_sensor().inverse() * error.point.p_base;
    const double off_m = (*result.T_base_sensor * seen - error.point.p_base).norm();
    EXPECT_LT(off_m, 3 * error.sigma_m) << error.point.name;
    EXPECT_LT(error.sigma_m, 0.003) << error.point.name;
  }
}

}  // namespace
}  // namespace calibrd
