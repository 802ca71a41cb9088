// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/refine.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kDegree = 0.0174532925199433;

Refinement refined(std::size_t count, const SceneSettings& scene, const Pose& start,
                   const RefineSettings& settings = {}) {
  const std::vector<View> views = render_views(count, scene);
  auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
  return refine(prepared, scene.camera, start, settings);
}

TEST(Refine, FromACentimetreOffReachesTheTruth) {
  const Refinement r = refined(3, {}, off_by(true_T_base_sensor(), 0.01, 0.5 * kDegree, 1));
  const Vector6d error = difference(true_T_base_sensor(), r.T_base_sensor);
  EXPECT_LT(error.tail<3>().norm(), 1e-3);
  EXPECT_LT(error.head<3>().norm(), 1e-3);
  EXPECT_NEAR(r.sigma_factor, 1, 0.5);  // the scene's noise is the expected one
  EXPECT_NEAR(r.residual_rms_m, 1.4e-3, 0.4e-3);
}

TEST(Refine, TellsTheSensorsNoiseFromTheExpectedOne) {
  SceneSettings noisy;
  noisy.noise = 3;
  RefineSettings range_alone;  // the outline's noise does not grow with that of the range
  range_alone.use_depth_outline = false;
  const Refinement r = refined(2, noisy, true_T_base_sensor(), range_alone),
                   quiet = refined(2, {}, true_T_base_sensor(), range_alone);
  EXPECT_NEAR(r.sigma_factor / quiet.sigma_factor, 3, 0.4);
  EXPECT_GT(r.covariance.trace(), 6 * quiet.covariance.trace());
}

TEST(Refine, LooksForTheDepthOutlineUnlessToldNotTo) {
  RefineSettings range_alone;
  range_alone.use_depth_outline = false;
  const Refinement with = refined(2, {}, true_T_base_sensor()),
                   without = refined(2, {}, true_T_base_sensor(), range_alone);
  EXPECT_GT(with.depth_contour.found, 100U);
  EXPECT_EQ(without.depth_contour.found, 0U);
}

TEST(Refine, EndsWhereItStartsWhenThatIsTheSolution) {
  const Refinement first = refined(2, {}, true_T_base_sensor());
  const Refinement again = refined(2, {}, first.T_base_sensor);
  const Vector6d moved = difference(first.T_base_sensor, again.T_base_sensor);
  EXPECT_LT(moved.norm(), 0.5 * std::sqrt(first.covariance.trace()));
}

TEST(Refine, StopsWhenToldTo) {
  int calls = 0;
  RefineSettings settings;
  settings.keep_going = [&](double progress) {
    EXPECT_GT(progress, 0);
    EXPECT_LE(progress, 1);
    return ++calls < 2;
  };
  refined(1, {}, true_T_base_sensor(), settings);
  EXPECT_EQ(calls, 2);
}

TEST(Refine, OfARobotOutOfViewStaysFinite) {
  Pose away = true_T_base_sensor();
  away.linear() = away.linear() * exp_so3({0, 3.1, 0});
  const Refinement r = refined(1, {}, away);
  EXPECT_EQ(r.range.measured, 0U);
  EXPECT_TRUE(r.T_base_sensor.matrix().allFinite());
}

}  // namespace
}  // namespace calibrd
