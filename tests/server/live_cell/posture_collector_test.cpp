// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/posture_collector.hpp"

#include <gtest/gtest.h>

#include "server/live_cell/frame_average.hpp"

namespace calibrd {
namespace {

View view(double joint, std::uint16_t depth = 1000) {
  View v;
  v.depth = {2, 1, 0.001, {depth, 0}};
  v.joint_positions_rad = {0, joint};
  return v;
}

TEST(PostureCollector, CountsOnlyPosturesThatDiffer) {
  PostureCollector collector({2, 0.17, 1});
  collector.offer(view(0));
  collector.offer(view(0.1));
  EXPECT_EQ(collector.seen(), 1);
  EXPECT_TRUE(collector.is_waiting_for_motion());
  collector.offer(view(0.2));
  EXPECT_TRUE(collector.is_complete());
  collector.offer(view(0.9));
  EXPECT_EQ(collector.take_views().size(), 2U);
}

TEST(PostureCollector, ComparesWithEveryPostureSeen) {
  PostureCollector collector({3, 0.17, 1});
  for (const double joint : {0.0, 0.5, 0.05}) collector.offer(view(joint));
  EXPECT_EQ(collector.seen(), 2);
}

View moving_view(double joint) {
  View v = view(joint);
  v.is_moving = true;
  return v;
}

TEST(PostureCollector, AMovingRobotsViewIsAPostureOfItsOwnWhereSuchAreTaken) {
  PostureCollector collector({3, 0.17, 5, true});
  collector.offer(moving_view(0));
  collector.offer(moving_view(0.1));
  collector.offer(moving_view(0.2));
  EXPECT_EQ(collector.seen(), 2);
  for (int i = 0; i < 5; ++i) collector.offer(view(0.6));
  EXPECT_TRUE(collector.is_complete());
  const auto views = collector.take_views();
  EXPECT_TRUE(views[0].is_moving && views[1].is_moving && !views[2].is_moving);
}

TEST(PostureCollector, AMovingRobotsViewIsNotTakenOtherwise) {
  PostureCollector collector({1, 0.17, 1});
  collector.offer(moving_view(0));
  EXPECT_EQ(collector.seen(), 0);
}

TEST(PostureCollector, AveragesSeveralFramesOfAPosture) {
  PostureCollector collector({1, 0.17, 3});
  collector.offer(view(0, 1000));
  collector.offer(view(0, 1001));
  EXPECT_FALSE(collector.is_complete());
  collector.offer(view(0, 1001));
  ASSERT_TRUE(collector.is_complete());
  EXPECT_NEAR(collector.take_views().front().depth.depth_m(0, 0), 1.000667, 1e-4);
}

TEST(PostureCollector, FramesBeforeAMotionDoNotMixWithThoseAfterIt) {
  PostureCollector collector({1, 0.17, 2});
  collector.offer(view(0));
  collector.interrupt();
  collector.offer(view(0.01));
  EXPECT_EQ(collector.seen(), 0);
  collector.offer(view(0.01));
  EXPECT_EQ(collector.seen(), 1);
}

TEST(PostureCollector, StartsOverWithoutPosturesAndWithoutFramesOfOne) {
  PostureCollector collector({2, 0.17, 2});
  for (const double joint : {0.0, 0.0, 0.5}) collector.offer(view(joint));
  collector.start_over();
  EXPECT_EQ(collector.seen(), 0);
  collector.offer(view(0.5));
  EXPECT_EQ(collector.seen(), 0);
  collector.offer(view(0.5));
  EXPECT_EQ(collector.seen(), 1);
  for (const double joint : {0.0, 0.0}) collector.offer(view(joint));
  EXPECT_EQ(collector.take_views().size(), 2U);
}

TEST(PostureCollector, SettlesForLessButNotForTooLittle) {
  PostureCollector collector({5});
  collector.offer(view(0.0));
  collector.settle_for_less(2);
  EXPECT_FALSE(collector.is_complete());
  collector.offer(view(0.5));
  collector.settle_for_less(2);
  EXPECT_TRUE(collector.is_complete());
  EXPECT_EQ(collector.take_views().size(), 2U);
}

TEST(FrameAverage, PixelThatJumpsIsNotPutBetweenForegroundAndBackground) {
  const std::vector<View> views{view(0, 1000), view(0, 1002), view(0, 1800)};
  const auto average = average_views(views);
  EXPECT_NEAR(average.depth.depth_m(0, 0), 1.001, 1e-6);
}

TEST(FrameAverage, PixelWithFewMeasurementsHasNone) {
  const std::vector<View> views{view(0, 0), view(0, 0), view(0, 1000)};
  EXPECT_EQ(average_views(views).depth.raw[0], 0);
}

TEST(FrameAverage, LargeDepthsStayWithinSixteenBits) {
  const std::vector<View> views{view(0, 60000), view(0, 60000)};
  const auto average = average_views(views);
  EXPECT_NEAR(average.depth.depth_m(0, 0), 60.0, 1e-9);
}

TEST(FrameAverage, ViewsOfOneCaptureHaveOneUnit) {
  const std::vector<View> far{view(0, 60000), view(0, 60001)}, near{view(1, 1000), view(1, 1001)};
  std::vector<View> views{average_views(near), view(2, 1500), average_views(near)};
  bring_to_one_unit(views);
  for (const View& each : views) EXPECT_EQ(each.depth.scale_m, views[0].depth.scale_m);
  EXPECT_NEAR(views[0].depth.depth_m(0, 0), 1.0005, 1e-9) << "digits are kept where they fit";
  EXPECT_NEAR(views[1].depth.depth_m(0, 0), 1.5, 1e-9);
  views.push_back(average_views(far));
  bring_to_one_unit(views);
  EXPECT_NEAR(views[0].depth.depth_m(0, 0), 1.0005, 1e-3);
  EXPECT_NEAR(views[3].depth.depth_m(0, 0), 60.0005, 1e-3);
}

TEST(FrameAverage, ImagesAreAveragedOnlyWhenEveryFrameHasOne) {
  std::vector<View> views{view(0), view(0)};
  views[0].image = GreyImage{2, 1, {10, 20}};
  EXPECT_FALSE(average_views(views).image);
  views[1].image = GreyImage{2, 1, {20, 40}};
  EXPECT_EQ(average_views(views).image->pixels, (std::vector<std::uint16_t>{15, 30}));
}

TEST(PostureCollector, StaysCompleteOnceItsViewsAreTaken) {
  PostureCollector collector({2, 0.17, 1});
  for (const double joint : {0.0, 0.5}) collector.offer(view(joint));
  EXPECT_EQ(collector.take_views().size(), 2U);
  collector.offer(view(1.0));
  EXPECT_TRUE(collector.is_complete());
  EXPECT_EQ(collector.seen(), 2);
  EXPECT_TRUE(collector.take_views().empty());
}

}  // namespace
}  // namespace calibrd
