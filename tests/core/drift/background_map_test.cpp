// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_map.hpp"

#include <gtest/gtest.h>

#include "tests/core/drift/room.hpp"

namespace calibrd {
namespace {

using namespace test;

/// Depth of the furnished room without its arm at a cell.
double true_depth_m(std::size_t cell) {
  static const View view = [] {
    Room room = Room::furnished();
    room.has_arm = false;
    room.noise_sigma_m = 0;
    return room.seen_from(true_T_base_sensor(), {});
  }();
  const int width = Room::camera().subsampled(kBackgroundStride).width;
  return view.depth.depth_m(kBackgroundStride * (static_cast<int>(cell) % width),
                            kBackgroundStride * (static_cast<int>(cell) / width));
}

TEST(BackgroundMap, KnowsWhatIsBehindTheRobotFromOtherPostures) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  const auto hidden = mask_of(room, postures(1)[0]);
  std::size_t behind = 0, wrong = 0;
  for (std::size_t i = 0; i < map.cells().size(); ++i) {
    const BackgroundCell& cell = map.cells()[i];
    if (!cell.has_plane()) continue;
    behind += hidden[i];
    wrong += std::abs(cell.depth_m - true_depth_m(i)) > 0.008;  // 4 m away the noise is more
  }
  EXPECT_GT(behind, 200U);
  EXPECT_EQ(wrong, 0U);
}

TEST(BackgroundMap, OnePostureLeavesUnknownWhatItHides) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room, 1);
  const auto hidden = mask_of(room, postures(1)[0]);
  for (std::size_t i = 0; i < map.cells().size(); ++i)
    if (hidden[i] != 0) {
      EXPECT_EQ(map.cells()[i].depth_m, 0) << i;
    }
}

TEST(BackgroundMap, SomebodyInOneOfTheViewsIsNotLearnt) {
  Room room = Room::furnished();
  std::vector<View> views;
  std::vector<std::vector<std::uint8_t>> masks;
  for (const auto& joints : postures(6)) {
    room.hidden_share = views.size() == 2 ? 0.4 : 0;
    views.push_back(room.seen_from(true_T_base_sensor(), joints));
    masks.push_back(mask_of(room, joints));
  }
  BackgroundMap map(Room::camera());
  map.learn(views, masks);
  for (std::size_t i = 0; i < map.cells().size(); ++i)
    if (map.cells()[i].has_plane()) {
      EXPECT_NEAR(map.cells()[i].depth_m, true_depth_m(i), 0.012) << i;
    }
}

TEST(BackgroundMap, EdgesHaveNoPlane) {
  Room room = Room::furnished();
  room.has_arm = false;
  const BackgroundMap map = learnt(room);
  const int width = map.grid().width;
  std::size_t edges = 0;
  for (std::size_t i = 0; i + 1 < map.cells().size(); ++i) {
    if (static_cast<int>(i % static_cast<std::size_t>(width)) + 1 == width) continue;
    if (std::abs(map.cells()[i].depth_m - map.cells()[i + 1].depth_m) < 0.1) continue;
    ++edges;
    EXPECT_FALSE(map.cells()[i].has_plane()) << i;
    EXPECT_FALSE(map.cells()[i + 1].has_plane()) << i;
  }
  EXPECT_GT(edges, 50U);
  EXPECT_GT(map.planes(), 5000U);
}

TEST(BackgroundMap, NoViewNoBackground) {
  BackgroundMap map(Room::camera());
  map.learn({}, {});
  EXPECT_TRUE(map.is_empty());
}

TEST(BackgroundMap, RelearnsOnlyWhatIsChosen) {
  Room room = Room::furnished();
  room.has_arm = false;
  BackgroundMap map = learnt(room);
  const auto before = map.cells();
  std::vector<float> depth_m(before.size(), 1.5F), frames(before.size(), 30);
  std::vector<std::uint8_t> chosen(before.size(), 0);
  const auto width = static_cast<std::size_t>(map.grid().width);
  for (std::size_t y = 40; y < 60; ++y)
    for (std::size_t x = 40; x < 60; ++x) chosen[y * width + x] = 1;
  map.relearn(depth_m, frames, chosen);
  EXPECT_EQ(map.cells()[50 * width + 50].depth_m, 1.5F);
  EXPECT_EQ(map.cells()[50 * width + 50].frames, 30);
  EXPECT_TRUE(map.cells()[50 * width + 50].has_plane());
  EXPECT_FALSE(map.cells()[40 * width + 50].has_plane());  // the rim of it is an edge now
  for (std::size_t i = 0; i < before.size(); ++i)
    if (chosen[i] == 0) {
      EXPECT_EQ(map.cells()[i].depth_m, before[i].depth_m);
    }
}

TEST(BackgroundMap, MoreFramesMakeItBetterUpToALimit) {
  Room room = Room::furnished();
  room.has_arm = false;
  BackgroundMap map = learnt(room, 1);
  const std::vector<std::uint8_t> chosen(map.cells().size(), 1);
  const auto rms = [&] {
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < map.cells().size(); ++i)
      if (map.cells()[i].has_plane()) {
        squares += std::pow(map.cells()[i].depth_m - true_depth_m(i), 2);
        ++count;
      }
    return std::sqrt(squares / count);
  };
  const double first = rms();
  for (int n = 0; n < 100; ++n) {
    const View view = room.seen_from(true_T_base_sensor(), {});
    std::vector<float> depth_m;
    for (int y = 0; y < map.grid().height; ++y)
      for (int x = 0; x < map.grid().width; ++x)
        depth_m.push_back(
            static_cast<float>(view.depth.depth_m(kBackgroundStride * x, kBackgroundStride * y)));
    map.refine(depth_m, chosen);
  }
  EXPECT_LT(rms(), 0.35 * first);
  EXPECT_EQ(map.cells()[5000].frames, BackgroundMap::kMostFrames);
}

TEST(BackgroundMap, WhatIsRecalledIsTheMeanOfItsViewsAndStaysSo) {
  Room room = Room::furnished();
  const BackgroundMap one = learnt(room, 6);
  BackgroundMap recalled(Room::camera());
  recalled.recall(one.depths_m(), 6);
  EXPECT_NEAR(static_cast<double>(recalled.planes()), static_cast<double>(one.planes()), 1);
  EXPECT_EQ(recalled.cells()[5000].frames, 3);
  recalled.refine(std::vector<float>(one.cells().size(), 1.0F),
                  std::vector<std::uint8_t>(one.cells().size(), 1));
  EXPECT_EQ(recalled.depths_m(), one.depths_m());
}

}  // namespace
}  // namespace calibrd
