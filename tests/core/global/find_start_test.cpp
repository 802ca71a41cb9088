// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/find_start.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

std::vector<StartHypothesis> starts_of(std::span<const View> views) {
  return find_starts(prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {}), ideal_kinect2(), {});
}

void expect_near_truth(const std::vector<StartHypothesis>& starts) {
  ASSERT_FALSE(starts.empty());
  const Vector6d error = difference(true_T_base_sensor(), starts.front().T_base_sensor);
  EXPECT_LT(error.tail<3>().norm(), 0.08);
  EXPECT_LT(error.head<3>().norm(), 0.08);
  if (starts.size() > 1) {
    EXPECT_GT(starts[0].score.value(), starts[1].score.value() + 0.1);
  }
}

class FindStart : public testing::TestWithParam<std::size_t> {};

TEST_P(FindStart, FindsTheSensorFromNothingAmongClutterAndASecondArm) {
  SceneSettings scene;
  scene.clutter = scene.second_arm = true;
  scene.offset_m = 0.018;
  expect_near_truth(starts_of(render_views(GetParam(), scene)));
}

INSTANTIATE_TEST_SUITE_P(Postures, FindStart, testing::Values(3, 4, 6));

/// A person: a tall box that stands elsewhere in each view, between sensor and arm in one.
void let_a_person_walk_by(std::vector<View>& views) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    DepthImage& depth = views[v].depth;
    const int left = 20 + 90 * static_cast<int>(v);
    const auto at = static_cast<std::uint16_t>(900 + 150 * v);
    for (int y = 60; y < depth.height; ++y)
      for (int x = left; x < left + 90 && x < depth.width; ++x) {
        std::uint16_t& raw = depth.raw[depth.index(x, y)];
        if (raw == 0 || raw > at) raw = at;
      }
  }
}

TEST(FindStart, IsNotMisledByAPersonWhoWalksBy) {
  SceneSettings scene;
  scene.clutter = true;
  std::vector<View> views = render_views(5, scene);
  let_a_person_walk_by(views);
  expect_near_truth(starts_of(views));
}

TEST(FindStart, SaysNothingWhenNothingMoves) {
  SceneSettings scene;
  scene.clutter = true;
  EXPECT_TRUE(starts_of(render_views(1, scene)).empty());
  const View still = render_views(1, scene)[0];
  EXPECT_TRUE(starts_of(std::vector<View>{still, still, still}).empty());
}

TEST(RenderScores, FallWhenTheSensorLooksThroughTheRobot) {
  const Pose beside = true_T_base_sensor() * Pose(Eigen::Translation3d(0.5, 0, 0));
  SceneSettings walled;
  walled.clutter = true;
  const auto cluttered = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), render_views(3, walled), {});
  const std::vector<Pose> poses{true_T_base_sensor(), beside};
  const auto scores = render_scores(cluttered, {}, ideal_kinect2(), poses, {});
  EXPECT_GT(scores[0].value(), 0.9);
  EXPECT_EQ(scores[0].seen_through, 0U);
  EXPECT_LT(scores[1].value(), 0);
  EXPECT_GT(scores[1].seen_through, 100U);
}

}  // namespace
}  // namespace calibrd
