// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/range_residuals.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"
#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;

struct Compared {
  NormalEquations equations;
  RangeTally tally;
};

/// One view of the arm against what a pose predicts, all measured depths moved by `nearer_m` first.
Compared compare(const SceneSettings& scene, const Pose& T_base_sensor, double nearer_m = 0,
                 const RangeSettings& settings = {}) {
  std::vector<View> views = render_views(1, scene);
  auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
  for (float& z : prepared[0].depth_m)
    if (z > 0) z -= static_cast<float>(nearer_m);
  Compared result;
  add_range_residuals(prepared[0], measured(prepared[0].cell, scene.camera, T_base_sensor), scene.camera,
                      T_base_sensor, {}, settings, result.equations, result.tally);
  return result;
}

TEST(RangeResiduals, AtTheTruthAreTheNoise) {
  const auto [equations, tally] = compare({}, true_T_base_sensor());
  EXPECT_GT(tally.measured, 3000U);
  EXPECT_GT(tally.agreeing, 0.99 * static_cast<double>(tally.measured));
  EXPECT_EQ(tally.seen_through, 0U);
  EXPECT_EQ(tally.occluded, 0U);
  EXPECT_NEAR(equations.rms_residual(), 1.6e-3, 0.3e-3);  // 1.4 mm head on, more when slanted
  double squares = 0;
  for (const float w : tally.whitened) squares += static_cast<double>(w) * w;
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(tally.whitened.size())), 1.0, 0.2);
}

TEST(RangeResiduals, SomethingInFrontIsCountedAsOccluded) {
  SceneSettings scene;
  scene.hidden_share = 1;
  const auto [equations, tally] = compare(scene, true_T_base_sensor());
  EXPECT_EQ(tally.occluded, tally.measured);
  EXPECT_GT(tally.measured, 3000U);
  EXPECT_EQ(equations.count(), 0U);
}

TEST(RangeResiduals, SpaceBehindTheRobotIsCountedAsSeenThrough) {
  const auto [equations, tally] = compare({}, true_T_base_sensor(), -0.2);
  EXPECT_EQ(tally.seen_through, tally.measured);
  EXPECT_EQ(equations.count(), 0U);
}

TEST(RangeResiduals, PixelsWithoutAMeasurementCountAsPredictedOnly) {
  SceneSettings scene;
  std::vector<View> views = render_views(1, scene);
  std::ranges::fill(views[0].depth.raw, std::uint16_t{0});
  const auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
  NormalEquations equations;
  RangeTally tally;
  add_range_residuals(prepared[0], measured(prepared[0].cell, scene.camera, true_T_base_sensor()),
                      scene.camera, true_T_base_sensor(), {}, {}, equations, tally);
  EXPECT_GT(tally.predicted, 3000U);
  EXPECT_EQ(tally.measured, 0U);
}

TEST(RangeResiduals, StrideThinsBothDirections) {
  RangeSettings every_third;
  every_third.stride = 3;
  const auto all = compare({}, true_T_base_sensor()),
             thinned = compare({}, true_T_base_sensor(), 0, every_third);
  EXPECT_NEAR(static_cast<double>(all.tally.predicted) / static_cast<double>(thinned.tally.predicted), 9, 1);
}

TEST(RangeResiduals, TalliesAddUp) {
  RangeTally sum = compare({}, true_T_base_sensor()).tally;
  const RangeTally one = sum;
  sum.merge(one);
  EXPECT_EQ(sum.predicted, 2 * one.predicted);
  EXPECT_EQ(sum.measured, 2 * one.measured);
  EXPECT_EQ(sum.agreeing, 2 * one.agreeing);
  EXPECT_EQ(sum.whitened.size(), 2 * one.whitened.size());
}

}  // namespace
}  // namespace calibrd
