// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/registration/range_residuals.hpp"
#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;

/// What one measured pixel adds to the sums.
struct OnePixel {
  ParameterVector jacobian;
  double residual = 0;
};

constexpr double kMeasuredBeyond_m = 0.002;

/// All pixels of the view are without a measurement but this one, which lies a little beyond the prediction.
std::optional<OnePixel> observe(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor,
                                const DepthCorrection& correction, int x, int y) {
  const VirtualMeasurement prediction = measured(cell, camera, T_base_sensor);
  const std::size_t i = pixel(prediction, x, y);
  RegistrationView view{cell,
                        {},
                        JointAxes(cell.robot(), cell.link_poses()),
                        std::vector<float>(prediction.depth_m.size(), 0.0F),
                        {},
                        0,
                        std::make_shared<const PixelRays>(camera)};
  view.depth_m[i] = static_cast<float>(correction.measured(prediction.depth_m[i]) + kMeasuredBeyond_m);
  NormalEquations equations;
  RangeTally tally;
  add_range_residuals(view, prediction, camera, T_base_sensor, correction, {}, equations, tally);
  if (equations.count() != 1) return std::nullopt;
  // w J Jᵀ and w r J, where J is 1 for the offset.
  const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
  const double weight = information(kOffset, kOffset);
  return OnePixel{information.col(kOffset) / weight, equations.gradient()[kOffset] / weight};
}

double predicted(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor,
                 const DepthCorrection& correction, int x, int y) {
  return correction.measured(cell.hit_along(camera.ray(x, y), T_base_sensor).depth_m);
}

/// Central difference of the rendered prediction by the pose.
Vector6d rendered_slope(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor,
                        const DepthCorrection& correction, int x, int y) {
  constexpr double kStep = 1e-3;
  Vector6d slope;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    slope[k] = (predicted(cell, camera, perturbed(T_base_sensor, step), correction, x, y) -
                predicted(cell, camera, perturbed(T_base_sensor, -step), correction, x, y)) /
               (2 * kStep);
  }
  return slope;
}

/// A large slanted board fills the picture: every pixel stays on it while the sensor is perturbed.
RobotModel slanted_board() {
  Pose T_base_board = shift(0.1, 0.05, 0.3);
  T_base_board.linear() = exp_so3({0.3, -0.2, 0.5}) * looking_at({1.1, -0.7, 0.9}, {0.1, 0.05, 0.3}).linear();
  return robot_from(link("base", box_shape({3, 3, 0.1}, T_base_board)));
}

TEST(RangeJacobian, EqualsTheSlopeOfTheRenderedDepth) {
  const RobotModel robot = slanted_board();
  const VirtualCell cell(robot);
  CameraModel lens = small_camera();
  lens.distortion = {0.09, -0.27, 0.002, -0.001, 0.09};
  for (const CameraModel& camera : {small_camera(), lens}) {
    for (const auto& [x, y] : {std::pair{80, 60}, {10, 12}, {150, 20}, {33, 110}, {140, 105}}) {
      const auto seen = observe(cell, camera, skew_pose(), {}, x, y);
      ASSERT_TRUE(seen) << x << ' ' << y;
      const Vector6d slope = rendered_slope(cell, camera, skew_pose(), {}, x, y);
      EXPECT_LT((seen->jacobian.head<6>() - slope).norm(), 2e-3 * slope.norm()) << x << ' ' << y;
      EXPECT_GT(slope.norm(), 0.5);
    }
  }
}

TEST(RangeJacobian, FollowsTheRangeCorrection) {
  const RobotModel robot = slanted_board();
  const VirtualCell cell(robot);
  const CameraModel camera = small_camera();
  const DepthCorrection correction{1.05, 0.01, 0.004, -0.003, 0.3};
  for (const auto& [x, y] : {std::pair{80, 60}, {20, 100}}) {
    const auto seen = observe(cell, camera, skew_pose(), correction, x, y);
    ASSERT_TRUE(seen);
    const Vector6d slope = rendered_slope(cell, camera, skew_pose(), correction, x, y);
    EXPECT_LT((seen->jacobian.head<6>() - slope).norm(), 3e-3 * slope.norm());
  }
}

TEST(RangeJacobian, EqualsTheSlopeByEveryTermOfTheCorrection) {
  const RobotModel robot = slanted_board();
  const VirtualCell cell(robot);
  const CameraModel camera = small_camera();
  const DepthCorrection correction{1.01, 0.01, 0.004, -0.003, 0.7};
  const auto seen = observe(cell, camera, skew_pose(), correction, 70, 50);
  ASSERT_TRUE(seen);
  const auto slope = [&](double DepthCorrection::*term) {
    constexpr double kStep = 1e-4;
    DepthCorrection more = correction, less = correction;
    more.*term += kStep;
    less.*term -= kStep;
    return (predicted(cell, camera, skew_pose(), more, 70, 50) -
            predicted(cell, camera, skew_pose(), less, 70, 50)) /
           (2 * kStep);
  };
  EXPECT_NEAR(seen->jacobian[kOffset], slope(&DepthCorrection::offset_m), 1e-5);
  EXPECT_NEAR(seen->jacobian[kScale], slope(&DepthCorrection::scale), 1e-5);
  EXPECT_NEAR(seen->jacobian[kSine], slope(&DepthCorrection::periodic_sin_m), 1e-5);
  EXPECT_NEAR(seen->jacobian[kCosine], slope(&DepthCorrection::periodic_cos_m), 1e-5);
  EXPECT_NEAR(seen->jacobian[kPeriod], slope(&DepthCorrection::periodic_period_m), 1e-5);
}

TEST(RangeJacobian, ResidualIsMeasuredMinusPredicted) {
  const RobotModel robot = slanted_board();
  const auto seen = observe(VirtualCell(robot), small_camera(), skew_pose(), {1.01, 0.01, 0, 0, 0}, 70, 50);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->residual, kMeasuredBeyond_m, 1e-6);
}

}  // namespace
}  // namespace calibrd
