// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>

#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

/// Squared error in units of the covariance claimed: χ² with 6 degrees of freedom when the claim is true.
double squared_sigmas(const CalibrationResult& result) {
  const Vector6d error = difference(true_T_base_sensor(), *result.T_base_sensor);
  return error.dot(result.covariance.ldlt().solve(error));
}

void expect_covers_the_error(SceneSettings scene, std::size_t postures) {
  constexpr int kRuns = 6;
  double mean = 0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    scene.seed = 50 + run;
    const CalibrationResult result = calibrated(render_views(postures, scene), scene, rough_guess(run));
    ASSERT_EQ(result.verdict, Verdict::accepted) << described(result);
    EXPECT_LT(squared_sigmas(result), 38.3) << described(result);  // exceeded once in a million
    mean += squared_sigmas(result) / kRuns;
  }
  EXPECT_LT(mean, 15);   // 6 ± 1.4 expected
  EXPECT_GT(mean, 1.0);  // no false modesty either
}

TEST(Uncertainty, CoversTheErrorOfOnePosture) { expect_covers_the_error({}, 1); }

TEST(Uncertainty, CoversTheErrorOfTwoPostures) { expect_covers_the_error({}, 2); }

TEST(Uncertainty, CoversTheErrorOfTwoPosturesWithImages) {
  SceneSettings scene;
  scene.images = true;
  expect_covers_the_error(scene, 2);
}

TEST(Uncertainty, GrowsWithTheNoise) {
  SceneSettings noisy;
  noisy.noise = 2;
  const CalibrationResult quiet = calibrated(render_views(2)),
                          loud = calibrated(render_views(2, noisy), noisy);
  EXPECT_GT(loud.sigma_position_m, 1.6 * quiet.sigma_position_m);
}

TEST(Uncertainty, ShrinksWithMorePostures) {
  double before_m = 1, before_rad = 1;
  for (const std::size_t count : {1, 2, 4, 6}) {
    const CalibrationResult result = calibrated(render_views(count));
    EXPECT_LT(result.sigma_position_m, before_m) << count;
    EXPECT_LT(result.sigma_rotation_rad, before_rad) << count;
    before_m = result.sigma_position_m;
    before_rad = result.sigma_rotation_rad;
  }
}

TEST(Uncertainty, IsASymmetricPositiveDefiniteCovariance) {
  SceneSettings scene;
  scene.images = true;
  for (const std::size_t count : {1, 2}) {
    const CalibrationResult result = calibrated(render_views(count, scene), scene);
    const Matrix6d& c = result.covariance;
    EXPECT_LT((c - c.transpose()).norm(), 1e-9 * c.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(c).eigenvalues()[0], 0);
    EXPECT_NEAR(result.sigma_rotation_rad, std::sqrt(c.topLeftCorner<3, 3>().trace()), 1e-12);
    EXPECT_NEAR(result.sigma_position_m, std::sqrt(c.bottomRightCorner<3, 3>().trace()), 1e-12);
  }
}

TEST(Uncertainty, OfNothingKnownIsLarge) {
  const CalibrationResult result = calibrated({});
  EXPECT_GE(result.sigma_position_m, 1);
  EXPECT_GE(result.sigma_rotation_rad, 1);
}

TEST(Uncertainty, TheSameFrameAgainMakesNothingSurer) {
  const View view = render_views(1)[0];
  const CalibrationResult once = calibrated({view}), often = calibrated({view, view, view, view});
  EXPECT_GT(often.sigma_position_m, 0.9 * once.sigma_position_m);
  EXPECT_GT(often.sigma_rotation_rad, 0.9 * once.sigma_rotation_rad);
}

}  // namespace
}  // namespace calibrd
