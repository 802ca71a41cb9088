// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/registration/registration_view.hpp"
#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr int kSide = 16;

/// 1 m everywhere, then 2 m from column 8 on; a hole at (3, 3). Raw units of 0.5 mm.
View step_view() {
  View view;
  view.depth = {kSide, kSide, 0.0005, {}};
  for (int i = 0; i < kSide * kSide; ++i) view.depth.raw.push_back(i % kSide < 8 ? 2000 : 4000);
  view.depth.raw[view.depth.index(3, 3)] = 0;
  view.image = GreyImage{kSide, kSide, std::vector<std::uint16_t>(kSide * kSide, 400)};
  return view;
}

const RobotModel& hinge() {
  static const RobotModel robot =
      robot_from(link("base") + link("arm", box_shape({0.4, 0.1, 0.1}, shift(0.2, 0, 0))) +
                 revolute("joint", "base", "arm", "0 0 1", Pose::Identity()));
  return robot;
}

std::vector<RegistrationView> prepared(const View& view, const PrepareSettings& settings = {}) {
  const CameraModel camera{kSide, kSide, 20, 20, 8, 8, {0, 0, 0, 0, 0}};
  return prepare_views(VirtualCell(hinge()), camera, std::vector{view}, settings);
}

View at_joint(View view, double position) {
  view.joint_positions_rad = {position};
  return view;
}

TEST(PrepareViews, DepthIsInMetres) {
  const auto views = prepared(at_joint(step_view(), 0));
  EXPECT_FLOAT_EQ(views[0].depth_m[static_cast<std::size_t>(10 * kSide + 5)], 1.0F);
  EXPECT_FLOAT_EQ(views[0].depth_m[static_cast<std::size_t>(10 * kSide + 12)], 2.0F);
}

TEST(PrepareViews, PixelsBesideADepthStepOrAHoleAreDropped) {
  const auto views = prepared(at_joint(step_view(), 0));
  const auto at = [&](int x, int y) { return views[0].depth_m[static_cast<std::size_t>(y * kSide + x)]; };
  EXPECT_EQ(at(7, 10), 0.0F);
  EXPECT_EQ(at(8, 10), 0.0F);
  EXPECT_GT(at(6, 10), 0.0F);
  EXPECT_GT(at(9, 10), 0.0F);
  for (const auto& [x, y] : {std::pair{3, 3}, {2, 3}, {4, 3}, {3, 2}, {3, 4}}) EXPECT_EQ(at(x, y), 0.0F);
  EXPECT_GT(at(4, 4), 0.0F);
}

TEST(PrepareViews, SmoothSlopesAreKept) {
  View view = at_joint(step_view(), 0);
  for (int i = 0; i < kSide * kSide; ++i)
    view.depth.raw[static_cast<std::size_t>(i)] =
        static_cast<std::uint16_t>(2000 + 30 * (i % kSide));  // 1.5 % a pixel
  const auto views = prepared(view);
  for (int x = 1; x + 1 < kSide; ++x)
    EXPECT_GT(views[0].depth_m[static_cast<std::size_t>(5 * kSide + x)], 0.0F);
}

TEST(PrepareViews, EachViewsRobotStandsAtItsOwnJoints) {
  const CameraModel camera{kSide, kSide, 20, 20, 8, 8, {0, 0, 0, 0, 0}};
  const std::vector<View> two{at_joint(step_view(), 0), at_joint(step_view(), 1.0)};
  const VirtualCell cell(hinge());
  const auto views = prepare_views(cell, camera, two, {});
  const auto tip = [](const VirtualCell& c) -> Eigen::Vector3d {
    return c.link_poses()[1] * Eigen::Vector3d(0.4, 0, 0);
  };
  EXPECT_LT((tip(views[0].cell) - Eigen::Vector3d(0.4, 0, 0)).norm(), 1e-12);
  EXPECT_LT((tip(views[1].cell) - 0.4 * Eigen::Vector3d(std::cos(1.0), std::sin(1.0), 0)).norm(), 1e-12);
}

TEST(PrepareViews, ImagesAreLeftOutWhenNotWanted) {
  PrepareSettings depth_only;
  depth_only.use_images = false;
  EXPECT_FALSE(prepared(at_joint(step_view(), 0))[0].image.empty());
  EXPECT_TRUE(prepared(at_joint(step_view(), 0), depth_only)[0].image.empty());
}

TEST(PrepareViews, SmoothingKeepsTheMeanAndNoiseIsNeverZero) {
  const auto views = prepared(at_joint(step_view(), 0));
  for (const float grey : views[0].image) EXPECT_FLOAT_EQ(grey, 400.0F);
  EXPECT_GT(views[0].image_noise, 0);
}

}  // namespace
}  // namespace calibrd
