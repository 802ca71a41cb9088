// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/conversions.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace calibrd {
namespace {

const std::vector<std::string> kJoints{"joint_1", "joint_2", "joint_3"};

std::vector<double> mapped(const RobotConfig& robot, std::vector<double> controller) {
  controller.resize(10);
  const auto mapping = JointMapping::make(mapping_config(robot, kJoints), kJoints);
  EXPECT_TRUE(mapping) << mapping.error().message();
  return *mapping->positions(controller);
}

TEST(Conversions, JointsFollowTheirOwnPlaceUnlessConfigured) {
  EXPECT_EQ(mapped({}, {0.1, 0.2, 0.3}), (std::vector<double>{0.1, 0.2, 0.3}));
}

TEST(Conversions, JointSettingsReachTheMapping) {
  RobotConfig robot;
  robot.joints["joint_2"].sign = -1;
  robot.joints["joint_2"].offset_deg = 90;
  const auto positions = mapped(robot, {0.1, 0.2, 0.3});
  EXPECT_DOUBLE_EQ(positions[1], -0.2 + std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(positions[2], 0.3);
}

TEST(Conversions, CouplingNamesTheOtherJointsAxis) {
  RobotConfig robot;
  robot.joints["joint_2"].axis = 2;
  robot.joints["joint_3"].axis = 1;
  robot.joints["joint_3"].coupling["joint_2"] = 1.0;
  EXPECT_EQ(mapped(robot, {0.0, 0.5, 0.25}), (std::vector<double>{0.0, 0.25, 0.75}));
}

TEST(Conversions, UnknownJointIsNamedWithTheNearest) {
  RobotConfig robot;
  robot.joints["jiont_2"].sign = -1;
  const auto mapping = JointMapping::make(mapping_config(robot, kJoints), kJoints);
  ASSERT_FALSE(mapping);
  EXPECT_NE(mapping.error().message().find("joint_2"), std::string::npos);
}

TEST(Conversions, SensorKeysReachTheSensorProcess) {
  SensorConfig sensor;
  sensor.camera.width = 640;
  sensor.image = "color";
  sensor.oni_file = "/a.oni";
  sensor.loop = true;
  sensor.depth_unit_um = 100;
  const auto settings = sensor_settings("eye", sensor);
  EXPECT_EQ(settings.stream.width, 640);
  EXPECT_EQ(settings.stream.image, ImageKind::color);
  EXPECT_EQ(settings.stream.recording, "/a.oni");
  EXPECT_TRUE(settings.stream.loop);
  EXPECT_EQ(settings.stream.depth_unit_um, 100);
}

TEST(Conversions, MirrorReachesSensorAndCell) {
  SensorConfig sensor;
  EXPECT_FALSE(sensor_setup("eye", sensor).mirror);
  sensor.mirror = true;
  EXPECT_TRUE(sensor_setup("eye", sensor).mirror);
  EXPECT_TRUE(sensor_settings("eye", sensor).stream.mirror);
}

TEST(Conversions, KeysOfTimeReachTheCell) {
  Config config;
  SensorConfig sensor;
  EXPECT_TRUE(sensor_setup("eye", sensor).estimates_time_offset);
  EXPECT_TRUE(cell_settings(config, "").gate.timed_views);  // for checks
  EXPECT_FALSE(cell_settings(config, "").jobs.collector.moving_views);
  EXPECT_TRUE(cell_settings(config, "").gate.trust_in_motion);
  sensor.time_offset = "off";
  config.calibration.views = "still_or_timed";
  config.robot.trust_in_motion = false;
  EXPECT_FALSE(sensor_setup("eye", sensor).estimates_time_offset);
  EXPECT_TRUE(cell_settings(config, "").jobs.collector.moving_views);
  EXPECT_FALSE(cell_settings(config, "").gate.trust_in_motion);
}

TEST(Conversions, LinkKeysReachTheClient) {
  RobotConfig robot;
  robot.host = std::string("h");
  robot.byte_order = std::string("little");
  robot.driver = "ur_rtde";
  robot.group = 2;
  robot.link.stale_after = Duration(111);
  robot.link.eviction_pause = Duration(222);
  const auto settings = link_settings(robot);
  EXPECT_EQ(settings.driver, "ur_rtde");
  EXPECT_EQ(settings.group, 2);
  EXPECT_EQ(settings.byte_order, simple_message::ByteOrder::little);
  EXPECT_EQ(settings.link.stale_after, Duration(111));
  EXPECT_EQ(settings.link.eviction_pause, Duration(222));
}

TEST(Conversions, MotionKeysReachTheClientAndTheCell) {
  Config config;
  config.robot.host = std::string("h");
  config.robot.port = 50299;
  config.robot.group = 1;
  config.robot.link.stale_after = Duration(111);
  config.motion.port = 50298;
  config.motion.max_speed_deg_s = 18;
  config.motion.max_acceleration_deg_s2 = 36;
  config.motion.path_tolerance_deg = 1.8;
  config.motion.hold = Duration(333);
  config.motion.routes["tour"].postures_deg = {{180, -90}};
  const auto client = motion_client_settings(config);
  EXPECT_EQ(client.host, "h");
  EXPECT_EQ(client.port, 50298);
  EXPECT_EQ(client.state_port, 50299);
  EXPECT_EQ(client.motion.group, 1);
  EXPECT_NEAR(client.motion.limits.max_speed_rad_s, 0.1 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(client.motion.limits.max_acceleration_rad_s2, 0.2 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(client.motion.path.joint_rad, 0.01 * std::numbers::pi, 1e-12);
  EXPECT_EQ(client.motion.hold, Duration(333));
  EXPECT_EQ(client.watch.stale_after, Duration(111));
  const auto cell = motion_settings(config.motion);
  EXPECT_FALSE(cell.enabled);
  EXPECT_NEAR(cell.routes_rad.at("tour")[0][1], -0.5 * std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace calibrd
