// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/moving_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

std::vector<RegistrationView> prepared(std::span<const View> views) {
  return prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
}

/// Share of the pixels marked as moving that show the arm.
double share_on_arm(std::span<const RegistrationView> views, const std::vector<MovingPoints>& moving) {
  std::size_t on_arm = 0, marked = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    VirtualMeasurement truth;
    views[v].cell.measure(ideal_kinect2(), true_T_base_sensor(), truth);
    for (std::size_t i = 0; i < moving[v].mask.size(); ++i) {
      marked += moving[v].mask[i];
      on_arm += moving[v].mask[i] != 0 && truth.link[i] >= 0 ? 1 : 0;
    }
  }
  return marked > 500 ? static_cast<double>(on_arm) / static_cast<double>(marked) : 0;
}

TEST(MovingPoints, AreOnTheArmAmongClutterAndBesideAStillArmOfTheSameMake) {
  SceneSettings scene;
  scene.clutter = scene.second_arm = true;
  const auto views = prepared(render_views(4, scene));
  const auto moving = find_moving_points(views, ideal_kinect2(), {});
  EXPECT_GT(share_on_arm(views, moving), 0.97);
  for (const MovingPoints& of_view : moving) EXPECT_GT(of_view.points.size(), 30U);
}

TEST(MovingPoints, AreSeenBeforeOpenSpace) {
  const auto views = prepared(render_views(3));  // the arm alone: nothing is measured beside it
  EXPECT_GT(share_on_arm(views, find_moving_points(views, ideal_kinect2(), {})), 0.97);
}

TEST(MovingPoints, WhatAHoleHidInOneViewHasNotMoved) {
  SceneSettings scene;
  scene.clutter = true;
  std::vector<View> views = render_views(4, scene);
  // Somebody nearer than the sensor measures: a large hole in one view.
  DepthImage& depth = views[1].depth;
  for (int y = 100; y < 300; ++y)
    for (int x = 0; x < 150; ++x) depth.raw[depth.index(x, y)] = 0;
  const auto ready = prepared(views);
  EXPECT_GT(share_on_arm(ready, find_moving_points(ready, ideal_kinect2(), {})), 0.97);
}

TEST(MovingPoints, OneViewShowsNone) {
  const auto views = prepared(render_views(1));
  const auto moving = find_moving_points(views, ideal_kinect2(), {});
  ASSERT_EQ(moving.size(), 1U);
  EXPECT_TRUE(moving[0].points.empty());
}

}  // namespace
}  // namespace calibrd
