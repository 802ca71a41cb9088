// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/paper_method.hpp"

#include <gtest/gtest.h>

#include "core/calibration/calibrate.hpp"
#include "core/paper/paper_error.hpp"
#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

/// Error of the pose found from a guess 30 mm and 2 degrees off.
Vector6d error_with(const PaperSettings& settings, const SceneSettings& scene = {}) {
  const Pose guess = off_by(true_T_base_sensor(), 0.03, 2 * kDegree, 5);
  const auto fit = fit_by_paper(test_arm(), scene.camera, render_views(1, scene).front(), guess, settings);
  if (!fit) {
    ADD_FAILURE() << fit.error().message();
    return Vector6d::Ones();
  }
  EXPECT_TRUE(fit->converged);
  EXPECT_GT(fit->measured_points, 500U);
  EXPECT_GT(fit->model_points, fit->measured_points);
  return difference(true_T_base_sensor(), fit->T_base_sensor);
}

TEST(PaperMethod, EndsWithinThePublishedErrors) {
  for (const PaperSampling sampling : {PaperSampling::uniform, PaperSampling::three_sensors}) {
    PaperSettings settings;
    settings.sampling = sampling;
    const Vector6d error = error_with(settings);
    EXPECT_LT(error.tail<3>().cwiseAbs().maxCoeff(), 0.022);
    EXPECT_LT(error.head<3>().cwiseAbs().maxCoeff(), 0.023);
  }
}

TEST(PaperMethod, UsesTheRegionItIsGiven) {
  const View view = render_views(1).front();
  const auto points_with = [&](double from_m, double to_m) {
    PaperSettings settings;
    settings.region_sensor =
        Eigen::AlignedBox3d(Eigen::Vector3d(-5, -5, from_m), Eigen::Vector3d(5, 5, to_m));
    const auto fit = fit_by_paper(test_arm(), ideal_kinect2(), view, true_T_base_sensor(), settings);
    return fit ? fit->measured_points : 0;
  };
  const std::size_t all = points_with(0.2, 3), near_half = points_with(0.2, 1.5),
                    far_half = points_with(1.5, 3);
  EXPECT_GT(near_half, 100U);
  EXPECT_GT(far_half, 100U);
  EXPECT_NEAR(static_cast<double>(near_half + far_half), static_cast<double>(all), 100);  // voxels cut in two
  EXPECT_EQ(points_with(8, 9), 0U);
}

TEST(CalibrateByPaper, NamesWhatIsMissing) {
  CalibrationSettings settings;
  settings.method = Method::paper;
  const std::vector<View> views = render_views(1);
  EXPECT_TRUE(has_reason(calibrate(test_arm(), ideal_kinect2(), views, settings), "guess_needed"));
  settings.guess_T_base_sensor = true_T_base_sensor();
  settings.paper.region_sensor = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 8), Eigen::Vector3d(1, 1, 9));
  const CalibrationResult result = calibrate(test_arm(), ideal_kinect2(), views, settings);
  EXPECT_TRUE(has_reason(result, "robot_not_found"));
  EXPECT_EQ(result.verdict, Verdict::rejected);
  EXPECT_FALSE(result.T_base_sensor);
}

}  // namespace
}  // namespace calibrd
