// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/robot_drivers.hpp"

#include <gtest/gtest.h>

#include "drivers/robot/robot_link_error.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"

namespace calibrd {
namespace {

std::error_code error_of(const StateClientSettings& settings) {
  const Status checked = check(settings);
  return checked ? std::error_code() : checked.error().code;
}

StateClientSettings of(const std::string& driver) {
  StateClientSettings settings;
  settings.driver = driver;
  settings.host = "controller";
  if (const RobotDriver* found = find_robot_driver(driver)) {
    settings.port = found->default_port;
    settings.joint_count = found->max_joints;
  }
  return settings;
}

TEST(RobotDrivers, EachHasADefaultThatIsUsableAndACodec) {
  EXPECT_EQ(robot_driver_names(), (std::vector<std::string>{"simple_message", "ur_rtde"}));
  for (const RobotDriver& driver : robot_drivers()) {
    const StateClientSettings settings = of(std::string(driver.name));
    EXPECT_FALSE(error_of(settings)) << driver.name;
    EXPECT_NE(driver.make_codec(settings), nullptr) << driver.name;
  }
}

TEST(RobotDrivers, EachMakesItsOwnCodec) {
  EXPECT_TRUE(find_robot_driver("simple_message")->make_codec(of("simple_message"))->begin().empty());
  EXPECT_EQ(find_robot_driver("ur_rtde")->make_codec(of("ur_rtde"))->begin(), rtde_bytes::hex("0005560002"));
}

TEST(RobotDrivers, TheSettingsReachTheCodecOfRtde) {
  StateClientSettings settings = of("ur_rtde");
  settings.joint_count = 5;
  settings.max_position = 2;
  const auto codec = find_robot_driver("ur_rtde")->make_codec(settings);
  (void)codec->begin();
  const auto take = [&](const rtde_bytes::Data& data) {
    return codec->decode(rtde_bytes::data(data), Clock::now());
  };
  (void)codec->decode(rtde_bytes::handshake(), Clock::now());
  EXPECT_EQ(take({}).joints->positions_rad.size(), 5U);
  EXPECT_FALSE(take({.timestamp_s = 101, .positions = {2.5}}).joints);
  settings.joint_ranges = {{-0.01, 0.01}};
  const auto strict = find_robot_driver("ur_rtde")->make_codec(settings);
  (void)strict->begin();
  EXPECT_FALSE(
      strict->decode(rtde_bytes::operator+(rtde_bytes::handshake(), rtde_bytes::data()), Clock::now())
          .joints);
}

TEST(RobotDrivers, AnUnknownDriverIsRefused) {
  EXPECT_EQ(find_robot_driver("rtde"), nullptr);
  EXPECT_EQ(error_of(of("rtde")), RobotLinkError::driver_unknown);
}

TEST(RobotDrivers, RtdeCarriesSixJoints) {
  StateClientSettings settings = of("ur_rtde");
  settings.joint_count = 7;
  EXPECT_EQ(error_of(settings), RobotLinkError::joint_count_out_of_range);
}

TEST(RobotDrivers, NoDriverIsLetOntoAPortThatCommandsARobot) {
  for (const std::string& driver : robot_driver_names()) {
    for (const int port : {50240, 50242, 11000, 11003, 29999, 30001, 30002, 30003}) {
      StateClientSettings settings = of(driver);
      settings.port = port;
      EXPECT_EQ(error_of(settings), RobotLinkError::port_commands_the_robot) << driver << port;
    }
  }
}

}  // namespace
}  // namespace calibrd
