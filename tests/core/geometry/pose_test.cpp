// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace calibrd {
namespace {

Pose example() {
  Pose T = Pose::Identity();
  T.linear() = exp_so3({0.3, -1.1, 0.7});
  T.translation() << 0.5, -0.2, 1.3;
  return T;
}

TEST(Pose, LogUndoesExpUpToHalfATurn) {
  for (double angle : {0.0, 1e-13, 1e-7, 0.5, 3.0, std::numbers::pi - 1e-7}) {
    const Eigen::Vector3d rotation = angle * Eigen::Vector3d(1, -2, 2) / 3.0;
    EXPECT_LT((log_so3(exp_so3(rotation)) - rotation).norm(), 1e-9) << angle;
  }
}

TEST(Pose, DifferenceUndoesPerturbation) {
  Vector6d delta;
  delta << 0.02, -0.03, 0.01, 0.004, 0.005, -0.006;
  EXPECT_LT((difference(example(), perturbed(example(), delta)) - delta).norm(), 1e-12);
}

TEST(Pose, PerturbationTurnsAboutTheSensorOrigin) {
  Vector6d delta;
  delta << 0.1, 0, 0, 0, 0, 0;
  EXPECT_LT((perturbed(example(), delta).translation() - example().translation()).norm(), 1e-15);
}

TEST(Pose, TurnedAboutKeepsThePivotWhereItIs) {
  const Eigen::Vector3d pivot(0, 0, 1.3);
  const Pose turned = turned_about(example(), pivot, {0.05, 0.02, -0.03}, Eigen::Vector3d::Zero());
  EXPECT_LT((turned * pivot - example() * pivot).norm(), 1e-12);
  EXPECT_GT((turned.translation() - example().translation()).norm(), 0.01);
}

}  // namespace
}  // namespace calibrd
