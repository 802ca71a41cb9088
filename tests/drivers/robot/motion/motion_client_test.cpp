// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/drivers/robot/motion/motion_client_fixture.hpp"

namespace calibrd {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

TEST_F(MotionClientTest, VisitsPosturesAndClosesThePort) {
  start({posture(0.4, 0.0, 0.3), posture(0.2, 0.1, 0.2)});
  wait_for_end(std::nullopt);
  EXPECT_EQ(reached_, 2u);
  const auto joints = robot();
  for (const auto& [joint, expected] : {std::pair{0, 0.2}, {1, 0.1}, {2, 0.2}})
    EXPECT_NEAR(joints[static_cast<std::size_t>(joint)], expected, 1e-6);
  wait_for([&] { return !simulator_.run([this] { return motion_.has_client(); }); });
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 1u);
  EXPECT_EQ(counts().count(200111), 0u);
}

TEST_F(MotionClientTest, OpensNothingUntilItIsAskedTo) {
  wait_for([&] { return !client_->doubt(); });
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 0u);
}

TEST_F(MotionClientTest, AStopStopsTheRobotAndEndsTrajectoryMode) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  client_->stop(MotionError::stop_requested);
  wait_for_end(MotionError::stop_requested);
  expect_the_robot_stands();
  EXPECT_LT(robot()[0], 1.0);
  const auto sent = counts();
  for (const std::int32_t command : {200111, 200122, 200130}) EXPECT_EQ(sent.at(command), 1) << command;
  wait_for([&] { return client_->doubt().has_value(); });
  EXPECT_EQ(client_->doubt()->code, MotionError::motion_not_possible);
}

TEST_F(MotionClientTest, AnEmergencyStopEndsIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.e_stopped = 1; });
  wait_for([&] { return end_.has_value(); });
  ASSERT_TRUE(end_ && end_->error);  // the next status says so, or the answer to the next point
  EXPECT_NE(end_->error->message().find("emergency stop"), std::string::npos) << end_->error->message();
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AStateLinkThatDiesEndsIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.mode = sim::ControllerSettings::Mode::refuse; });
  wait_for_end(MotionError::link_down);
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, JointsThatFreezeEndIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.mode = sim::ControllerSettings::Mode::frozen; });
  wait_for_end(MotionError::off_path);
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AnotherClientOfThePortEndsItAndIsTold) {
  start({posture(0.1, 0.2, 0.3)});  // stands still at it: nothing is queued in the end
  wait_for([&] { return reached_ == 1; });
  asio::io_context io;
  asio::ip::tcp::socket other(io);
  other.connect({asio::ip::address_v4::loopback(), motion_.port()});
  wait_for_end(MotionError::closed_by_controller);
}

TEST_F(MotionClientTest, AnotherMotionIsRefusedMeanwhile) {
  start({posture(1.4, 0.0, 0.3)});
  const auto second = client_->start({posture(0.1, 0.2, 0.3), {posture(0, 0, 0)}}, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, MotionError::in_motion);
}

TEST_F(MotionClientTest, ClosingStopsTheRobotToo) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  client_->shut_down();
  wait_for_end(MotionError::daemon_ends);
  wait_for([&] { return !simulator_.run([this] { return motion_.has_client(); }); });
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AManualRobotIsNotMoved) {
  set([](auto& settings) { settings.automatic = 0; });
  wait_for([&] { return client_->doubt()->code == MotionError::not_automatic; });
  const auto begun = client_->start({posture(0.1, 0.2, 0.3), {posture(0, 0, 0)}}, {});
  ASSERT_FALSE(begun);
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 0u);
}

TEST(MotionClientSettings, PortsForOtherThingsAreRefused) {
  MotionClientSettings settings;
  EXPECT_TRUE(check(settings));
  for (const int port : {0, 70000, 50241, 50242, 11002, 11003}) {
    settings.port = port;
    ASSERT_FALSE(check(settings)) << port;
    EXPECT_EQ(check(settings).error().code, MotionError::port_not_for_motion);
  }
  settings.port = settings.state_port = 9000;
  EXPECT_FALSE(check(settings));
}

}  // namespace
}  // namespace calibrd
