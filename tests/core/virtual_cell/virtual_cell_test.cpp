// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/virtual_cell.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;
using std::numbers::pi;

TEST(VirtualCell, WritesEveryPixelOfAReusedMeasurement) {
  const RobotModel robot = robot_from(link("base", box_shape({0.2, 0.2, 0.2}, shift(0, 0, 1))));
  const VirtualCell cell(robot);
  for (const auto& [width, height] : {std::pair{160, 120}, {31, 17}, {97, 201}, {1, 1}, {160, 120}}) {
    const CameraModel camera{width, height, 100, 100, width / 2.0, height / 2.0, {0, 0, 0, 0, 0}};
    VirtualMeasurement reused{7, 9, std::vector<float>(100000, 9.0F),
                              std::vector<Eigen::Vector3f>(100000, Eigen::Vector3f::Ones()),
                              std::vector<std::int16_t>(100000, std::int16_t{5})};
    cell.measure(camera, Pose::Identity(), reused);
    const VirtualMeasurement fresh = measured(VirtualCell(robot), camera, Pose::Identity());
    EXPECT_EQ(reused.width, width);
    EXPECT_EQ(reused.height, height);
    EXPECT_EQ(reused.depth_m, fresh.depth_m);
    EXPECT_EQ(reused.normal, fresh.normal);
    EXPECT_EQ(reused.link, fresh.link);
  }
}

TEST(VirtualCell, CameraOfTheSameSizeButOtherLensGivesAnotherPicture) {
  const RobotModel robot = robot_from(link("base", box_shape({0.2, 0.2, 0.2}, shift(0, 0, 1))));
  const VirtualCell cell(robot);
  CameraModel camera{160, 120, 100, 100, 80, 60, {0, 0, 0, 0, 0}};
  const VirtualMeasurement first = measured(cell, camera, Pose::Identity());
  camera.cx += 10;
  const VirtualMeasurement moved = measured(cell, camera, Pose::Identity());
  EXPECT_EQ(first_column(moved, 60), first_column(first, 60) + 10);
  camera.distortion[0] = 20;
  EXPECT_GT(last_column(measured(cell, camera, Pose::Identity()), 60), last_column(moved, 60));
}

TEST(VirtualCell, RobotPartlyBehindTheSensorIsSeenWhereItIsInFront) {
  // A floor under the sensor reaches 3 m behind it, a box stands wholly behind it.
  const RobotModel robot = robot_from(link("base", box_shape({6, 0.1, 6}, shift(0, 0.55, 0))) +
                                      link("box", box_shape({0.4, 0.4, 0.1}, shift(0, 0, -1))) +
                                      revolute("joint", "base", "box", "0 0 1", Pose::Identity()));
  const CameraModel camera{101, 101, 80, 80, 50, 50, {0, 0, 0, 0, 0}};
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, Pose::Identity());
  for (int y = 0; y < camera.height; ++y) {
    const double depth = y > 50 ? 0.5 * 80 / (y - 50) : 0;  // of the floor's top, 0.5 m below the sensor
    for (int x = 0; x < camera.width; ++x) {
      const bool on_floor = depth > 0 && depth < 3;
      ASSERT_EQ(m.link[pixel(m, x, y)], on_floor ? 0 : -1) << x << ' ' << y;
      ASSERT_NEAR(m.depth_m[pixel(m, x, y)], on_floor ? depth : 0, 1e-5);
    }
  }
}

RobotModel swinging_arm() {
  return robot_from(link("base", box_shape({0.1, 0.1, 0.1})) +
                    link("arm", box_shape({0.4, 0.06, 0.06}, shift(0.2, 0, 0))) +
                    revolute("joint", "base", "arm", "0 0 1", shift(0, 0, 0.2)));
}

Pose from_above() {
  Pose T = shift(0, 0, 2);
  T.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();  // image right = base x, image down = base -y
  return T;
}

TEST(VirtualCell, JointTurnsThePicture) {
  const RobotModel robot = swinging_arm();
  VirtualCell cell(robot);
  const CameraModel camera{201, 201, 200, 200, 100, 100, {0, 0, 0, 0, 0}};
  const int arm = robot.find_link("arm").value();
  const auto sees_arm = [&](int x, int y) {
    const VirtualMeasurement m = measured(cell, camera, from_above());
    return m.link[pixel(m, x, y)] == arm;
  };
  EXPECT_TRUE(sees_arm(130, 100));
  EXPECT_FALSE(sees_arm(100, 70));
  cell.set_joints(std::vector{pi / 2});  // counter-clockwise seen from above: towards +y, up in the picture
  EXPECT_FALSE(sees_arm(130, 100));
  EXPECT_TRUE(sees_arm(100, 70));
  EXPECT_LT((cell.link_poses()[static_cast<std::size_t>(arm)] * Eigen::Vector3d(0.4, 0, 0) -
             Eigen::Vector3d(0, 0.4, 0.2))
                .norm(),
            1e-12);
}

TEST(VirtualCell, CopiesHaveJointsOfTheirOwn) {
  const RobotModel robot = swinging_arm();
  const CameraModel camera{201, 201, 200, 200, 100, 100, {0, 0, 0, 0, 0}};
  VirtualCell first(robot);
  first.set_joints(std::vector{0.3});
  const VirtualMeasurement before = measured(first, camera, from_above());
  VirtualCell second(first);
  EXPECT_EQ(measured(second, camera, from_above()).depth_m, before.depth_m);  // a copy starts where we stand
  second.set_joints(std::vector{1.2});
  EXPECT_EQ(measured(first, camera, from_above()).depth_m, before.depth_m);
  EXPECT_NE(measured(second, camera, from_above()).depth_m, before.depth_m);
  first.set_joints(std::vector{1.2});
  EXPECT_EQ(measured(first, camera, from_above()).depth_m, measured(second, camera, from_above()).depth_m);
}

TEST(VirtualCell, CopyOutlivesItsOriginal) {
  const RobotModel robot = swinging_arm();
  const CameraModel camera{201, 201, 200, 200, 100, 100, {0, 0, 0, 0, 0}};
  auto original = std::make_unique<VirtualCell>(robot);
  const VirtualMeasurement before = measured(*original, camera, from_above());
  VirtualCell copy(*original);
  original.reset();
  EXPECT_EQ(measured(copy, camera, from_above()).depth_m, before.depth_m);
  const VirtualCell moved(std::move(copy));
  EXPECT_EQ(measured(moved, camera, from_above()).depth_m, before.depth_m);
}

TEST(VirtualCell, WrongJointCountIsRefusedAndLeavesTheRobotWhereItStood) {
  const RobotModel robot = swinging_arm();
  VirtualCell cell(robot);
  cell.set_joints(std::vector{0.5});
  const Pose before = cell.link_poses()[1];
  EXPECT_THROW(cell.set_joints(std::vector{0.1, 0.2}), std::invalid_argument);
  EXPECT_TRUE(cell.link_poses()[1].isApprox(before));
}

TEST(VirtualCell, RobotWithoutSurfacesGivesAnEmptyPicture) {
  const RobotModel robot = robot_from(link("base"));
  const VirtualMeasurement m = measured(VirtualCell(robot), small_camera(), skew_pose());
  EXPECT_EQ(m.depth_m, std::vector<float>(161 * 121, 0.0F));
  EXPECT_EQ(m.link, std::vector<std::int16_t>(161 * 121, std::int16_t{-1}));
}

}  // namespace
}  // namespace calibrd
