// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Wrong intrinsics, wrong joint zeros: what the verdict must not let pass as good, and what results may
// claim.
#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

double squared_sigmas(const CalibrationResult& result) {
  const Vector6d error = difference(true_T_base_sensor(), *result.T_base_sensor);
  return error.dot(result.covariance.ldlt().solve(error));
}

// Intrinsics taken from the driver: a Kinect v2 reports the field of view of a Kinect v1 (a quarter too
// narrow).
class WrongFocalLength : public testing::TestWithParam<double> {};

TEST_P(WrongFocalLength, IsNotServedAsGood) {
  for (const bool images : {false, true}) {
    SceneSettings scene;
    scene.images = images;
    const std::vector<View> views = render_views(3, scene);
    scene.camera.fx *= GetParam();
    scene.camera.fy *= GetParam();
    const CalibrationResult result = calibrated(views, scene);
    SCOPED_TRACE(described(result) + " range offset " + std::to_string(result.depth_correction.offset_m) +
                 " m, scale " + std::to_string(result.depth_correction.scale));
    EXPECT_NE(result.verdict, Verdict::accepted);
  }
}

INSTANTIATE_TEST_SUITE_P(, WrongFocalLength, testing::Values(0.9, 1.1, 1.25), [](const auto& test) {
  return "Times" + std::to_string(std::lround(100 * test.param)) + "Percent";
});

// A small joint zero error bends the whole fit without making outliers.
class JointZeroOff : public testing::TestWithParam<std::tuple<int, double>> {};

TEST_P(JointZeroOff, IsNotServedAsGood) {
  const auto [joint, degrees] = GetParam();
  std::vector<View> views = render_views(3);
  for (View& view : views) view.joint_positions_rad[static_cast<std::size_t>(joint - 1)] += degrees * kDegree;
  expect_right_or_not_accepted(calibrated(views), 3e-3, 3e-3);
}

INSTANTIATE_TEST_SUITE_P(, JointZeroOff,
                         testing::Combine(testing::Values(2, 3, 4), testing::Values(0.5, 1.0, 3.0)),
                         [](const auto& test) {
                           return "Joint" + std::to_string(std::get<0>(test.param)) + "By" +
                                  std::to_string(std::lround(1000 * std::get<1>(test.param))) +
                                  "Millidegrees";
                         });

TEST(Claims, OfOnePostureWithItsImageCoverTheError) {
  SceneSettings scene;
  scene.images = true;
  double mean = 0;
  for (std::uint64_t run = 0; run < 4; ++run) {
    scene.seed = 100 + run;
    mean += squared_sigmas(calibrated(render_views(1, scene), scene)) / 4;
  }
  EXPECT_LT(mean, 15);  // 6 is expected
}

TEST(Claims, OfARejectedResultAreLarge) {
  Pose away = true_T_base_sensor();
  away.linear() = away.linear() * exp_so3({0, 3.1, 0});
  const CalibrationResult result = calibrated(render_views(1), {}, away);
  ASSERT_EQ(result.verdict, Verdict::rejected);
  EXPECT_GT(result.sigma_position_m, 0.1);
  EXPECT_GT(result.sigma_rotation_rad, 0.1);
}

}  // namespace
}  // namespace calibrd
