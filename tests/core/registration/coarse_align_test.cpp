// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/coarse_align.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kDegree = 0.0174532925199433;

TEST(CoarseAlign, BringsFourCentimetresAmongClutterWithinReachOfTheRefinement) {
  SceneSettings scene;
  scene.clutter = true;
  const std::vector<View> views = render_views(3, scene);
  auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Pose guess = off_by(true_T_base_sensor(), 0.04, 4 * kDegree, seed);
    const Vector6d error = difference(true_T_base_sensor(), coarse_align(prepared, scene.camera, guess, {}));
    EXPECT_LT(error.head<3>().norm(), 1 * kDegree) << seed;
    EXPECT_LT(error.tail<3>().norm(), 0.02) << seed;
  }
}

TEST(CoarseAlign, WithoutMeasurementsKeepsTheGuess) {
  std::vector<View> views = render_views(1);
  std::ranges::fill(views[0].depth.raw, std::uint16_t{0});
  auto prepared = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
  EXPECT_TRUE(
      coarse_align(prepared, ideal_kinect2(), true_T_base_sensor(), {}).isApprox(true_T_base_sensor()));
}

TEST(CoarseAlign, OfARobotOutOfViewKeepsTheGuess) {
  const std::vector<View> views = render_views(1);
  auto prepared = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
  Pose away = true_T_base_sensor();
  away.linear() = away.linear() * exp_so3({0, 3.1, 0});  // looks the other way
  EXPECT_TRUE(coarse_align(prepared, ideal_kinect2(), away, {}).isApprox(away));
}

}  // namespace
}  // namespace calibrd
