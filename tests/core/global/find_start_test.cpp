// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/find_start.hpp"

#include <gtest/gtest.h>

#include "core/global/moving_points.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

std::vector<StartHypothesis> starts_of(std::span<const View> views) {
  const auto prepared = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
  return find_starts(prepared, robot_candidates(prepared, ideal_kinect2()), ideal_kinect2(), {});
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
  const View still = render_views(1, scene)[0];
  EXPECT_TRUE(starts_of(std::vector<View>{still, still, still}).empty());
}

TEST(FindStart, OfOneViewSaysWhereTheSensorMightBe) {
  const auto starts = starts_of(render_views(1));
  ASSERT_FALSE(starts.empty());
  const bool has_truth = std::ranges::any_of(starts, [](const StartHypothesis& start) {
    const Vector6d error = difference(true_T_base_sensor(), start.T_base_sensor);
    return error.tail<3>().norm() < 0.15 && error.head<3>().norm() < 0.15;
  });
  EXPECT_TRUE(has_truth) << "none of " << starts.size();
}

/// A wall with specks before it, each alone and elsewhere in each view.
std::vector<View> views_of_specks(std::size_t count) {
  std::vector<View> views = render_views(count);
  for (std::size_t v = 0; v < views.size(); ++v) {
    DepthImage& depth = views[v].depth;
    const auto raw = [&](double z_m) { return static_cast<std::uint16_t>(z_m / depth.scale_m); };
    std::ranges::fill(depth.raw, raw(1.5));
    for (int y = 40; y + 12 < depth.height; y += 80)
      for (int x = 40 + 20 * static_cast<int>(v); x + 12 < depth.width; x += 80)
        for (int k = 0; k < 144; ++k) depth.raw[depth.index(x + k % 12, y + k / 12)] = raw(1.2);
  }
  return views;
}

TEST(FindStart, SaysNothingWhenWhatMovesFormsNoGroup) {
  const auto views = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views_of_specks(4), {});
  const auto moving = robot_candidates(views, ideal_kinect2());
  for (const MovingPoints& of_view : moving)
    EXPECT_GT(of_view.points.size(), 8U);  // there is motion, but none of a robot
  EXPECT_TRUE(find_starts(views, moving, ideal_kinect2(), {}).empty());
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
