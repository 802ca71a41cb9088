// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/obstacle_clusters.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

constexpr int kWidth = 10, kHeight = 8;

/// A rectangle [x0, x1) x [y0, y1) of that depth.
void fill(std::vector<float>& depth_m, int x0, int y0, int x1, int y1, float z) {
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) depth_m[static_cast<std::size_t>(y * kWidth + x)] = z;
}
std::vector<float> nothing() { return std::vector<float>(kWidth * kHeight, 0.0F); }

TEST(DepthClusters, AreSplitByAStepInDepthAndByAGap) {
  auto depth_m = nothing();
  fill(depth_m, 0, 0, 4, 4, 1.0F);
  fill(depth_m, 4, 0, 8, 4, 1.2F);   // beside the first, farther
  fill(depth_m, 0, 5, 4, 8, 1.01F);  // a row of nothing between
  const auto clusters = depth_clusters(depth_m, kWidth, 0.05F, 4);
  ASSERT_EQ(clusters.size(), 3U);
  EXPECT_EQ(clusters[0].size(), 16U);
  EXPECT_EQ(clusters[1].size(), 16U);
  EXPECT_EQ(clusters[2].size(), 12U);
}

TEST(DepthClusters, LeaveOutWhatIsSmallOrOneCellWide) {
  auto depth_m = nothing();
  fill(depth_m, 0, 0, 2, 2, 1.0F);
  fill(depth_m, 5, 0, 6, 8, 1.0F);  // an edge of the background that flickers
  EXPECT_TRUE(depth_clusters(depth_m, kWidth, 0.05F, 5).empty());
  EXPECT_EQ(depth_clusters(depth_m, kWidth, 0.05F, 4).size(), 1U);
}

TEST(DepthClusters, DoNotReachFromTheEndOfARowToTheNext) {
  auto depth_m = nothing();
  fill(depth_m, 8, 0, 10, 3, 1.0F);
  fill(depth_m, 0, 1, 2, 4, 1.0F);
  EXPECT_EQ(depth_clusters(depth_m, kWidth, 0.05F, 4).size(), 2U);
}

}  // namespace
}  // namespace calibrd
