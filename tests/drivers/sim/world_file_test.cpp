// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/world_file.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <set>
#include <thread>

#include "drivers/sim/openni/world_watch.hpp"
#include "drivers/sim/world/sim_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd::sim {
namespace {

using calibrd::test::ScratchFolder;

Cell small_cell() {
  Cell cell;
  cell.robot.name = "arm";
  cell.robot.links.push_back({"base", -1, make_box({1, 2, 3}), {0.5F, 0.1F, 7}});
  cell.robot.joints.push_back(
      {"turn", Movement::turning, 0, 0, Eigen::Isometry3d::Identity(), {0, 0, 1}, 0, 1, 0});
  cell.robot.positions.push_back({"turn", -1, 1});
  cell.objects.push_back({"post", make_cylinder(0.1, 1.0), {}});
  return cell;
}

TEST(WorldFile, ReaderSeesTheCellAndTheState) {
  const ScratchFolder folder;
  WorldState state;
  state.joint_zero_rad[3] = 0.25;
  auto file = WorldFile::create(folder.path() / "world", small_cell(), state);
  ASSERT_TRUE(file);
  const auto view = WorldView::open(folder.path() / "world");
  ASSERT_TRUE(view);
  EXPECT_EQ(view->cell().robot.links[0].name, "base");
  EXPECT_TRUE(view->cell().robot.links[0].mesh.solid);
  EXPECT_EQ(view->cell().robot.joints[0].axis, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(view->cell().objects[0].mesh.triangles, small_cell().objects[0].mesh.triangles);
  EXPECT_EQ(view->read()->joint_zero_rad[3], 0.25);
  state.joint_zero_rad[3] = -0.5;
  file->publish(state);
  EXPECT_EQ(view->read()->joint_zero_rad[3], -0.5);
}

TEST(WorldFile, ReaderNeverSeesHalfAChange) {
  const ScratchFolder folder;
  WorldState state;
  state.person.speed_m_s = 0;
  auto file = WorldFile::create(folder.path() / "world", {}, state);
  ASSERT_TRUE(file);
  const auto view = WorldView::open(folder.path() / "world");
  ASSERT_TRUE(view);
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (double i = 1; !done; ++i) {
      state.motion.current.clock.program_s = i;  // at the front of the state, and at its end
      state.person.speed_m_s = i;
      file->publish(state);
      std::this_thread::sleep_for(std::chrono::microseconds(20));  // leaves room to read in
    }
  });
  // Long enough for the two to run side by side and to be interrupted anywhere.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  int torn = 0;
  std::set<double> seen;
  while (std::chrono::steady_clock::now() < end) {
    const auto read = view->read();
    if (!read) continue;
    torn += read->motion.current.clock.program_s != read->person.speed_m_s;
    seen.insert(read->person.speed_m_s);
  }
  done = true;
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_GT(seen.size(), 100U);
}

TEST(WorldFile, IsGoneWhenTheSimulatorEnds) {
  const ScratchFolder folder;
  const auto path = folder.path() / "world";
  auto file = std::make_unique<WorldFile>(*WorldFile::create(path, {}, {}));
  const auto view = WorldView::open(path);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->alive(monotonic_ns()));
  EXPECT_FALSE(view->alive(monotonic_ns() + 2 * kBeatLost_ns));
  file.reset();
  EXPECT_FALSE(view->alive(monotonic_ns()));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(WorldFile, WatchFindsTheNextSimulator) {
  const ScratchFolder folder;
  const auto path = folder.path() / "world";
  WorldWatch watch(path);
  EXPECT_EQ(watch.current(), nullptr);
  auto first = std::make_unique<WorldFile>(*WorldFile::create(path, {}, {}));
  const auto seen = watch.current();
  EXPECT_NE(seen, nullptr);
  EXPECT_EQ(watch.current(), seen);
  first.reset();
  EXPECT_EQ(watch.current(), nullptr);
  const auto second = WorldFile::create(path, {}, {});
  ASSERT_TRUE(second);
  EXPECT_NE(watch.current(), nullptr);
  EXPECT_NE(watch.current(), seen);
}

TEST(WorldFile, ForeignFileIsRefused) {
  const ScratchFolder folder;
  EXPECT_EQ(WorldView::open(folder.path() / "none").error().code,
            make_error_code(SimError::world_unreadable));
  const auto text = folder.write("text", std::string(100'000, 'x'));
  EXPECT_EQ(WorldView::open(text).error().code, make_error_code(SimError::world_mismatch));
  const auto empty = folder.write("empty", "");
  EXPECT_EQ(WorldView::open(empty).error().code, make_error_code(SimError::world_mismatch));
}

TEST(WorldFile, ASecondSimulatorDoesNotTakeItAway) {
  const ScratchFolder folder;
  const auto path = folder.path() / "world";
  auto first = std::make_unique<WorldFile>(*WorldFile::create(path, {}, {}));
  EXPECT_EQ(WorldFile::create(path, {}, {}).error().code, make_error_code(SimError::world_in_use));
  EXPECT_TRUE(WorldView::open(path)->alive(monotonic_ns()));
  first.reset();
  folder.write("world", "left over by one that was killed");
  EXPECT_TRUE(WorldFile::create(path, {}, {}));
}

TEST(WorldFile, UnwritablePlaceIsAnError) {
  EXPECT_EQ(WorldFile::create("/proc/nowhere/world", {}, {}).error().code,
            make_error_code(SimError::world_unwritable));
}

TEST(Cell, CutOffBytesAreRefused) {
  const auto bytes = to_bytes(small_cell());
  ASSERT_TRUE(cell_from_bytes(bytes));
  for (std::size_t length = 0; length < bytes.size(); length += 7)
    EXPECT_FALSE(cell_from_bytes(std::span(bytes).first(length))) << length;
}

}  // namespace
}  // namespace calibrd::sim
