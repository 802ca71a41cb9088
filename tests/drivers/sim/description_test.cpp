// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/description.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "drivers/sim/world/sim_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

using calibrd::test::ScratchFolder;

/// What is wrong with a description of the demo robot that goes on with `rest`.
std::string complaint(const std::string& rest) {
  const auto world = parse_description(R"({"robot": {})" + rest + "}", {}, {test::demo_urdf(), {}});
  return world ? "" : world.error().message();
}

TEST(Description, DemoCellIsComplete) {
  const auto world = read_description(test::demo_world(), {test::demo_urdf(), {}});
  ASSERT_TRUE(world) << world.error().message();
  EXPECT_EQ(world->cell.robot.positions.size(), 7U);
  EXPECT_GE(world->cell.objects.size(), 8U);
  ASSERT_EQ(world->state.sensor_count, 1);
  EXPECT_STREQ(world->state.sensors[0].id.data(), "kinect2");
  EXPECT_EQ(world->state.sensors[0].depth.noise, 1);
  EXPECT_GT(world->state.motion.next.program.posture_count, 2);
}

TEST(Description, SensorLooksAtItsTarget) {
  const World world = test::world_from(
      R"(, "sensors": [{"position_m": [1, 2, 1.5], "target_m": [0.2, 0.1, 0.3], "roll_deg": 10}])");
  const Eigen::Isometry3d T_base_sensor = world.state.sensors[0].T_base_sensor.pose();
  const Eigen::Vector3d target = T_base_sensor.inverse() * Eigen::Vector3d(0.2, 0.1, 0.3);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_GT(target.z(), 1);
  EXPECT_NEAR(T_base_sensor.linear().determinant(), 1, 1e-12);
  EXPECT_LT(T_base_sensor.linear().col(1).z(), -0.5);  // y points down
}

TEST(Description, MistakesAreNamedWithTheirPlace) {
  EXPECT_NE(complaint(R"(, "sensors": [{"idd": "x"}])").find("sensors[0].idd"), std::string::npos);
  EXPECT_NE(complaint(R"(, "objects": [{"name": "a"}])").find("objects[0].box_m"), std::string::npos);
  EXPECT_NE(complaint(R"(, "sensors": [{"camera": {"fx": 0}}])").find("sensors[0].camera.fx"),
            std::string::npos);
  EXPECT_NE(complaint(R"(, "controller": {"groups": 2.5})").find("controller.groups"), std::string::npos);
  EXPECT_NE(complaint(R"(, "wall": 1)").find("wall"), std::string::npos);
  EXPECT_NE(complaint(R"(, "sensors": 5)").find("sensors"), std::string::npos);
  EXPECT_NE(complaint(R"(, "joint_zero_rad": [1])").find("joint_zero_rad"), std::string::npos);
  EXPECT_NE(complaint(R"(, "sensors": [{},{},{},{},{},{},{},{},{}])").find("sensors"), std::string::npos);
  EXPECT_EQ(complaint(R"(, "note": "all is well")"), "");
}

TEST(Description, MissingFilesAreNamed) {
  EXPECT_EQ(read_description("/nowhere/world.json", {}).error().code,
            make_error_code(SimError::description_unreadable));
  const auto no_urdf = parse_description(R"({"robot": {"urdf": "none.urdf"}})", "/nowhere", {});
  EXPECT_EQ(no_urdf.error().code, make_error_code(SimError::urdf_unreadable));
  EXPECT_NE(no_urdf.error().message().find("/nowhere/none.urdf"), std::string::npos);
}

TEST(RobotFile, MeshThatIsNowhereIsNamed) {
  const ScratchFolder folder;
  const auto urdf = folder.write("a.urdf", R"(<robot name="a"><link name="b"><visual><geometry>
      <mesh filename="package://lost/m.stl"/></geometry></visual></link></robot>)");
  const auto robot = read_robot(urdf, {});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().code, make_error_code(SimError::mesh_not_found));
  EXPECT_NE(robot.error().message().find("package://lost/m.stl"), std::string::npos);
}

TEST(RobotFile, BrokenFilesAreErrors) {
  const ScratchFolder folder;
  EXPECT_EQ(read_robot(folder.write("x.urdf", "<robot"), {}).error().code,
            make_error_code(SimError::urdf_unreadable));
  folder.write("p/m.stl", "no mesh at all");
  const auto urdf = folder.write("a.urdf", R"(<robot name="a"><link name="b"><visual><geometry>
      <mesh filename="package://p/m.stl"/></geometry></visual></link></robot>)");
  EXPECT_EQ(read_robot(urdf, {}).error().code, make_error_code(SimError::mesh_unreadable));
  const auto stiff = folder.write("s.urdf", R"(<robot name="a"><link name="b"/></robot>)");
  EXPECT_EQ(read_robot(stiff, {}).error().code, make_error_code(SimError::no_joints));
}

TEST(RobotFile, JointsMoveTheirLinks) {
  const ScratchFolder folder;
  const auto urdf = folder.write("a.urdf", R"(<robot name="a"><link name="b"/><link name="c"/><link name="d"/>
      <joint name="turn" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0 0 1" rpy="0 0 0"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint>
      <joint name="slide" type="prismatic"><parent link="c"/><child link="d"/><origin xyz="1 0 0" rpy="0 0 0"/>
        <axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="0" velocity="0"/><mimic joint="turn" multiplier="2" offset="0.5"/></joint></robot>)");
  const auto robot = read_robot(urdf, {});
  ASSERT_TRUE(robot) << robot.error().message();
  ASSERT_EQ(robot->positions.size(), 1U);
  EXPECT_EQ(robot->positions[0].lower, -1);
  const auto poses = robot->link_poses(std::array{std::numbers::pi / 2});
  EXPECT_TRUE(
      poses[2].translation().isApprox(Eigen::Vector3d(0, 1 + 2 * std::numbers::pi / 2 + 0.5, 1), 1e-12));
}

TEST(Postures, StayClearOfTheCellAndRepeatWithTheSeed) {
  const auto world = read_description(test::demo_world(), {test::demo_urdf(), {}});
  ASSERT_TRUE(world);
  const MotionProgram& program = world->state.motion.next.program;
  for (int i = 0; i < program.posture_count; ++i)
    for (const auto& pose : world->cell.robot.link_poses(program.postures[static_cast<std::size_t>(i)]))
      EXPECT_GT(pose.translation().z(), -1e-9);  // no link's frame below the bench's top
  const auto again = read_description(test::demo_world(), {test::demo_urdf(), {}});
  EXPECT_EQ(again->state.motion.next.program.postures, program.postures);
}

}  // namespace
}  // namespace calibrd::sim
