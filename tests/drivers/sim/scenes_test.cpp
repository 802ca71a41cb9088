// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/sim/scenes/capture_folder.hpp"
#include "drivers/sim/scenes/simulate_capture.hpp"
#include "drivers/sim/world/sim_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

const Robot& demo_robot() {
  static const Robot robot = *read_robot(test::demo_urdf(), {});
  return robot;
}

std::shared_ptr<const SensorTables> tables() {
  static const auto made = std::make_shared<const SensorTables>(CameraParameters{});
  return made;
}

SimulatedCapture simulated(std::uint64_t seed, Level level, std::size_t postures = 3) {
  CaptureOptions options;
  options.level = level;
  options.postures = postures;
  auto capture = simulate_capture(demo_robot(), seed, options, tables());
  if (!capture) throw std::runtime_error(capture.error().message());
  return std::move(*capture);
}

double farthest_check_point(const SimulatedCapture& capture) {
  double most = 0;
  for (const auto& point : capture.check_points)
    most = std::max(most, (capture.T_base_sensor * point.p_sensor - point.p_base).norm());
  return most;
}

TEST(Scenes, SameSeedSameRecording) {
  const auto a = simulated(5, Level::field), b = simulated(5, Level::field), c = simulated(6, Level::field);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (std::size_t i = 0; i < a.views.size(); ++i) {
    EXPECT_EQ(a.views[i].depth_mm, b.views[i].depth_mm);
    EXPECT_EQ(a.views[i].infrared, b.views[i].infrared);
    EXPECT_EQ(a.views[i].joint_positions_rad, b.views[i].joint_positions_rad);
  }
  EXPECT_TRUE(a.T_base_sensor.isApprox(b.T_base_sensor, 0));
  EXPECT_NE(a.views[0].depth_mm, c.views[0].depth_mm);
}

TEST(Scenes, ShowEnoughOfTheRobotFromOneToTwoMetres) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto capture = simulated(seed, Level::cell);
    std::size_t pixels = 0;
    for (const auto& view : capture.views) pixels += view.robot_pixels;
    EXPECT_GE(pixels / capture.views.size(), 6000U);
    EXPECT_GT(capture.T_base_sensor.translation().norm(), 0.7);
    EXPECT_LT(capture.T_base_sensor.translation().norm(), 2.8);
    EXPECT_EQ(capture.check_points.size(), 30U);
  }
}

TEST(Scenes, CleanMeansTheRobotAloneAndNoiseAlone) {
  const auto capture = simulated(2, Level::clean);
  EXPECT_EQ(capture.depth_errors.offset_m, 0);
  EXPECT_EQ(capture.depth_errors.scale, 1);
  EXPECT_EQ(capture.depth_errors.wiggle_m, 0);
  for (const auto& view : capture.views) {
    std::size_t seen = 0;
    for (const auto mm : view.depth_mm) seen += mm != 0;
    EXPECT_EQ(seen, view.robot_pixels);
  }
}

TEST(Scenes, CheckPointsMeetUnlessTheJointsLie) {
  EXPECT_LT(farthest_check_point(simulated(3, Level::cell)), 1e-9);
  const auto field = simulated(3, Level::field);
  EXPECT_GT(farthest_check_point(field), 1e-5);
  EXPECT_LT(farthest_check_point(field), 5e-3);
  for (const double zero : field.joint_zero_rad) EXPECT_LE(std::abs(zero), 1e-3);
}

TEST(Scenes, TooMuchAskedIsAnError) {
  CaptureOptions options;
  options.level = Level::clean;
  options.postures = 1;
  options.min_robot_pixels = 200'000;
  const auto capture = simulate_capture(demo_robot(), 1, options, tables());
  ASSERT_FALSE(capture);
  EXPECT_EQ(capture.error().code, make_error_code(SimError::no_view_of_robot));
}

TEST(CaptureFolder, IsNeverWrittenOverAnother) {
  const calibrd::test::ScratchFolder folder;
  folder.write("mine", "keep");
  const Status written = write_capture_folder(folder.path(), simulated(1, Level::clean, 1), "robot.urdf");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, make_error_code(SimError::capture_unwritable));
}

}  // namespace
}  // namespace calibrd::sim
