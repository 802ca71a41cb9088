// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/point_grid.hpp"

#include <gtest/gtest.h>

#include <random>

namespace calibrd {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t count, float side, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-side / 2, side / 2);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(place(random), place(random), 0.3F * place(random));
  return points;
}

float nearest_by_looking_at_all(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query) {
  float best = std::numeric_limits<float>::infinity();
  for (const auto& p : points) best = std::min(best, (p - query).squaredNorm());
  return best;
}

TEST(PointGrid, NearestIsTheNearestOfAll) {
  const auto points = random_points(2000, 1, 1);
  const auto queries = random_points(500, 1.6F, 2);
  for (const float cell_m : {0.02F, 0.05F, 0.5F}) {
    const PointGrid grid(points, cell_m);
    for (const float reach_m : {0.04F, 0.2F, 2.0F}) {
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const float truth = nearest_by_looking_at_all(points, queries[i]);
        const int hint = i % 2 == 0 ? -1 : static_cast<int>((37 * i) % points.size());
        const auto found = grid.nearest(queries[i], reach_m, hint);
        ASSERT_EQ(found.index >= 0, truth < reach_m * reach_m);
        if (found.index < 0) continue;
        ASSERT_FLOAT_EQ(found.squared_distance, truth);
        ASSERT_FLOAT_EQ((grid.points()[static_cast<std::size_t>(found.index)] - queries[i]).squaredNorm(),
                        truth);
      }
    }
  }
}

TEST(PointGrid, OrderLeadsBackToTheCloud) {
  const auto points = random_points(300, 1, 3);
  const PointGrid grid(points, 0.1F);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(grid.points()[i], points[grid.order()[i]]);
}

TEST(PointGrid, BlocksHoldEveryNeighbourWithinACell) {
  const auto points = random_points(1500, 1, 4);
  const float cell_m = 0.08F;
  const PointGrid grid(points, cell_m);
  std::size_t visited = 0;
  grid.for_each_cell(0, grid.rows(), [&](PointGrid::Range own, std::span<const PointGrid::Range> block) {
    for (std::uint32_t i = own.begin; i < own.end; ++i, ++visited) {
      std::size_t in_block = 0, in_cloud = 0;
      const auto is_near = [&](const Eigen::Vector3f& p) { return (p - grid.points()[i]).norm() < cell_m; };
      for (const auto range : block)
        for (std::uint32_t j = range.begin; j < range.end; ++j) in_block += is_near(grid.points()[j]);
      for (const auto& p : points) in_cloud += is_near(p);
      ASSERT_EQ(in_block, in_cloud);
    }
  });
  EXPECT_EQ(visited, points.size());
}

TEST(PointGrid, AWideCloudGetsLargerCells) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {1e4F, -1e4F, 1e4F}, {1e4F, 1e4F, 3}};
  const PointGrid grid(points, 0.001F);
  EXPECT_GT(grid.cell_m(), 1);
  EXPECT_EQ(grid.points()[static_cast<std::size_t>(grid.nearest({9999, 9999, 0}, 10).index)], points[2]);
}

TEST(PointGrid, AnEmptyCloudHasNoNeighbours) {
  EXPECT_EQ(PointGrid({}, 0.1F).nearest(Eigen::Vector3f::Zero(), 1).index, -1);
}

}  // namespace
}  // namespace calibrd
