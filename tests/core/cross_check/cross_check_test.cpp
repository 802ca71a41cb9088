// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cross_check/cross_check.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/cross_check/fuse_poses.hpp"
#include "core/geometry/pose.hpp"
#include "tests/core/registration/scene.hpp"
#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kSigma_m = 5e-4, kSigma_rad = 5e-4;

/// Two sensors before the arm in its clutter, each with its background as it learnt it from the same
/// postures.
class TwoSensors : public ::testing::Test {
 protected:
  TwoSensors()
      : left_T_base_sensor_(true_T_base_sensor()),
        right_T_base_sensor_(looking_at({1.2, -0.75, 1.0}, {0.1, 0, 0.4})) {
    learn(left_T_base_sensor_, 1, left_);
    scene_.offset_m = 0.004;  // another sensor, another bias
    learn(right_T_base_sensor_, 100, right_);
    covariance_.setZero();
    covariance_.diagonal() << Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad),
        Eigen::Vector3d::Constant(kSigma_m * kSigma_m);
  }

  CheckedSensor left() const { return {left_, left_T_base_sensor_, covariance_, {}}; }
  CheckedSensor right(const Pose& T_base_sensor, const DepthCorrection& correction = {}) const {
    return {right_, T_base_sensor, covariance_, correction};
  }

  Pose left_T_base_sensor_, right_T_base_sensor_;
  Matrix6d covariance_;

 private:
  void learn(const Pose& T_base_sensor, std::uint64_t seed, BackgroundMap& background) {
    static const VirtualCell arm(test_arm());
    RobotMask mask(arm, scene_.camera);
    std::vector<View> views;
    for (const auto& joints : postures(3)) {
      scene_.seed = seed++;
      views.push_back(render_view(joints, T_base_sensor, scene_));
    }
    background = learn_background(mask, scene_.camera, views, T_base_sensor);
  }

  SceneSettings scene_ = [] {
    SceneSettings scene;
    scene.clutter = true;
    return scene;
  }();
  BackgroundMap left_{scene_.camera}, right_{scene_.camera};
};

TEST_F(TwoSensors, ThatStandWhereTheirPosesSayAgreeWhateverTheirRangeOffsets) {
  const CrossCheck check = cross_check(left(), right(right_T_base_sensor_));
  ASSERT_TRUE(check.has_overlap) << check.pairs;
  EXPECT_LT(check.sigmas, 1.5) << 1e3 * check.shift_m << " mm " << 1e3 * check.turn_rad << " mrad";
  EXPECT_FALSE(check.disagrees());
}

TEST_F(TwoSensors, ThatStandWhereTheirPosesSayAgreeThoughTheWigglesOfTheirRangeWereNotFound) {
  const CrossCheck check =
      cross_check(left(), right(right_T_base_sensor_, {1.003, 0.003, 0.004, -0.003, 0.9}));
  ASSERT_TRUE(check.has_overlap) << check.pairs;
  EXPECT_LT(check.sigmas, 1.2) << 1e3 * check.shift_m << " mm " << 1e3 * check.turn_rad << " mrad";
}

TEST_F(TwoSensors, OneOfWhichIsOffByTwentyMillimetresAndTwentyMilliradiansDisagree) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CrossCheck check = cross_check(left(), right(off_by(right_T_base_sensor_, 0.02, 0.02, seed)));
    EXPECT_TRUE(check.disagrees()) << seed << ": " << check.sigmas << " sigmas of " << check.pairs
                                   << " pairs";
  }
}

TEST_F(TwoSensors, OneOfWhichIsElsewhereAltogetherDisagree) {
  const CrossCheck check = cross_check(left(), right(off_by(right_T_base_sensor_, 0.4, 0.3, 3)));
  EXPECT_TRUE(check.disagrees()) << check.sigmas << " sigmas of " << check.pairs << " pairs";
}

TEST_F(TwoSensors, AnErrorOfOneIsMeasuredAsTheTurnAndShiftThatUndoesIt) {
  Vector6d delta;
  delta << 0.004, -0.003, 0.005, 0.006, -0.004, 0.005;
  const Pose wrong = perturbed(right_T_base_sensor_, delta);
  const CrossCheck check = cross_check(left(), right(wrong));
  const Eigen::Vector3d p = check.middle_base;
  Vector6d off;
  off << check.turn_shift.head<3>() + delta.head<3>(),
      wrong * (right_T_base_sensor_.inverse() * p) + check.turn_shift.tail<3>() - p;
  EXPECT_LT(off.head<3>().norm(), 0.003);  // of 7 mrad
  // Of the shift they know as much as their range errors leave, and say so.
  EXPECT_LT(off.dot(check.covariance.ldlt().solve(off)) / 6, 2);
  const Eigen::Matrix3d shift_covariance = check.covariance.bottomRightCorner<3, 3>();
  EXPECT_LT(shift_covariance.trace(), 0.02 * 0.02);
}

TEST_F(TwoSensors, OneOfWhichLooksTheOtherWaySayNothing) {
  const Pose away = right_T_base_sensor_ * Pose(Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitY()));
  const CrossCheck check = cross_check(left(), right(away));
  EXPECT_FALSE(check.has_overlap) << check.pairs << " pairs, " << check.seen_through << " seen through";
  EXPECT_FALSE(check.disagrees());
}

TEST_F(TwoSensors, ThePoorerPoseGainsFromTheBetterWhenTheyAreFused) {
  const Pose wrong = off_by(right_T_base_sensor_, 0.004, 0.003, 2);
  CheckedSensor poor = right(wrong);
  poor.covariance *= 64;
  const CheckedSensor good = left();
  const FusedPoses fused = fuse_poses(good, poor, cross_check(good, poor));
  const Vector6d before = difference(right_T_base_sensor_, wrong),
                 after = difference(right_T_base_sensor_, fused.second_T_base_sensor);
  EXPECT_LT(after.head<3>().norm(), 0.6 * before.head<3>().norm());
  EXPECT_LT(fused.second_covariance.trace(), 0.5 * poor.covariance.trace());
  EXPECT_LT(difference(left_T_base_sensor_, fused.first_T_base_sensor).tail<3>().norm(), 2 * kSigma_m);
}

}  // namespace
}  // namespace calibrd
