// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/motion_link.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "server/daemon/conversions.hpp"

namespace calibrd {
namespace {

/// A robot of two joints; `type` is that of the second.
RobotModel model_with(const std::string& type) {
  const auto file =
      std::filesystem::temp_directory_path() / ("calibrd_motion_" + std::to_string(getpid()) + ".urdf");
  std::ofstream(file) << R"(<robot name="r"><link name="base"/><link name="a"/><link name="b"/>
<joint name="one" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="1" effort="0"/></joint>
<joint name="two" type=")"
                      << type << R"("><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="1" effort="0"/></joint></robot>)";
  auto model = RobotModel::load(file);
  std::filesystem::remove(file);
  EXPECT_TRUE(model) << model.error().message();
  return *std::move(model);
}

std::string failure(const Config& config, const std::string& type = "revolute") {
  const auto model = model_with(type);
  const auto mapping =
      JointMapping::make(mapping_config(config.robot, model.position_names()), model.position_names());
  EXPECT_TRUE(mapping);
  const auto checked = check_motion(config, model, *mapping);
  return checked ? "" : checked.error().message();
}

Config enabled() {
  Config config;
  config.motion.enabled = true;
  return config;
}

TEST(CheckMotion, ARobotWhoseJointsTurnCanBeMoved) {
  auto config = enabled();
  config.motion.routes["tour"].postures_deg = {{10, 20}};
  EXPECT_EQ(failure(config), "");
}

TEST(CheckMotion, ARobotThatSlidesCannot) {
  EXPECT_NE(failure(enabled(), "prismatic").find("two slides"), std::string::npos);
  EXPECT_EQ(failure({}, "prismatic"), "") << "as long as motion is off";
}

TEST(CheckMotion, AControllerWithoutMotoRosCannot) {
  auto config = enabled();
  config.robot.driver = std::string("ur_rtde");
  EXPECT_NE(failure(config).find("only MotoROS"), std::string::npos);
}

TEST(CheckMotion, AScaledOrCoupledAxisCannot) {
  auto config = enabled();
  config.robot.joints["two"].scale = 2;
  EXPECT_NE(failure(config).find("motion.enabled: joint 2"), std::string::npos);
  config.robot.joints["two"].scale = 1;
  config.robot.joints["two"].coupling["one"] = 1;
  EXPECT_NE(failure(config).find("motion.enabled: joint 2"), std::string::npos);
}

TEST(CheckMotion, ARouteMustFitTheRobotAlsoWhileMotionIsOff) {
  Config config;
  config.motion.routes["tour"].postures_deg = {{10, 20}, {10, 20, 30}};
  EXPECT_NE(failure(config).find("motion.routes.tour.postures_deg: a posture has 3 positions"),
            std::string::npos);
}

TEST(CheckMotion, TheStatePortIsNoMotionPort) {
  auto config = enabled();
  config.motion.port = config.robot.port = 50300;
  EXPECT_NE(failure(config).find("motion.port = 50300"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
