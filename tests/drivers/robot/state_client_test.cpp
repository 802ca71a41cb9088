// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/state_client.hpp"

#include <boost/asio/thread_pool.hpp>

#include "tests/drivers/robot/state_client_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

TEST_F(StateClientTest, DeliversJointsAndStatus) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for([&] { return !recorder_.joints.empty() && !recorder_.statuses.empty(); }));
  ASSERT_TRUE(recorder_.wait_for_state(State::streaming));
  client_->stop();
  EXPECT_EQ(recorder_.joints[0].positions_rad.size(), 7u);
  EXPECT_FLOAT_EQ(static_cast<float>(recorder_.joints[0].positions_rad[6]), 0.7F);
  EXPECT_EQ(recorder_.joints[0].velocities_rad, std::vector<double>(7, 0.0));
  EXPECT_EQ(recorder_.statuses[0].drives_powered, true);
  EXPECT_EQ(client_->health().messages, 2u);
}

TEST_F(StateClientTest, ReadsACycleSentByteByByte) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send_byte_by_byte(cycle());
  EXPECT_TRUE(recorder_.wait_for([&] { return !recorder_.joints.empty() && !recorder_.statuses.empty(); }));
}

TEST_F(StateClientTest, NeverSendsAByte) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_joints(1));
  client_->stop();
  EXPECT_TRUE(connection.client_closes_without_a_word());
}

TEST_F(StateClientTest, ComesBackAfterAnOrderlyClose) {
  start();
  for (std::size_t i = 1; i <= 3; ++i) {
    PeerConnection connection = peer_.accept();
    connection.send(cycle());
    ASSERT_TRUE(recorder_.wait_for_joints(i));
  }
  ASSERT_TRUE(wait_for_reason(RobotLinkError::closed_by_controller));
}

TEST_F(StateClientTest, ComesBackAfterAReset) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_joints(1));
  connection.reset();
  connection = peer_.accept();
  connection.send(cycle());
  EXPECT_TRUE(recorder_.wait_for_joints(2));
}

TEST_F(StateClientTest, ComesBackWhenThePeerFallsSilentWithoutClosing) {
  start();
  PeerConnection silent = peer_.accept();
  silent.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_state(State::streaming));
  ASSERT_TRUE(recorder_.wait_for_state(State::silent));
  PeerConnection next = peer_.accept();
  next.send(cycle());
  EXPECT_TRUE(recorder_.wait_for_joints(2));
  EXPECT_TRUE(silent.client_closes_without_a_word()) << "one connection at a time";
}

TEST_F(StateClientTest, ReportsStaleJointsWhileTheStatusLives) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for([&] { return recorder_.statuses.size() == 1; }));
  const Bytes status(cycle().begin() + 148, cycle().end());
  const auto stale = [](const RobotLinkHealth& told) {
    return told.state == State::joints_stale && told.status_fresh;
  };
  for (std::size_t count = 2; !recorder_.has_report(stale); ++count) {
    connection.send(status);
    ASSERT_TRUE(recorder_.wait_for([&] { return recorder_.statuses.size() >= count; }));
  }
}

TEST_F(StateClientTest, DiagnosesTheByteOrder) {
  settings_.byte_order = simple_message::ByteOrder::little;
  start();
  peer_.accept().send(cycle());
  ASSERT_TRUE(recorder_.wait_for_state(State::faulted));
  EXPECT_EQ(client_->health().reason,
            "peer sends big endian, little is configured: set robot.byte_order = \"big\"");
}

TEST_F(StateClientTest, ReconnectsAfterRubbishAndReadsOn) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  connection.send(Bytes(64));
  ASSERT_TRUE(recorder_.wait_for_state(State::faulted));
  connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_joints(2));
  EXPECT_EQ(client_->health().framing_errors, 1u);
}

TEST_F(StateClientTest, LeavesTheSlotsToOthersAfterTwoEvictions) {
  settings_.link.eviction_within = 10s;
  settings_.link.eviction_pause = 60s;
  start();
  peer_.accept().send(cycle());
  peer_.accept().send(cycle());
  ASSERT_TRUE(wait_for_reason(RobotLinkError::evicted));
  EXPECT_FALSE(peer_.somebody_connects_within(200ms));
  expect_prompt_stop();
}

TEST_F(StateClientTest, WaitsForAControllerThatIsNotUpYet) {
  peer_.stop_listening();
  start();
  ASSERT_TRUE(wait_for_reason(RobotLinkError::refused));
  peer_.listen_again();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  EXPECT_TRUE(recorder_.wait_for_state(State::streaming));
}

TEST_F(StateClientTest, SurvivesTwoHundredDisconnectsWithoutGrowing) {
  start();
  std::size_t before = 0;
  for (std::size_t i = 1; i <= 200; ++i) {
    PeerConnection connection = peer_.accept();
    connection.send(cycle());
    ASSERT_TRUE(recorder_.wait_for_joints(i));
    if (i == 10) before = open_descriptors();
    if (i == 200) {
      EXPECT_EQ(open_descriptors(), before);
    } else if (i % 2) {
      connection.reset();
    }
  }
  client_->stop();
  EXPECT_EQ(recorder_.joints.back().sequence, 200u);
}

TEST_F(StateClientTest, WorksOnAPoolOfThreads) {
  boost::asio::thread_pool pool(3);
  auto created = StateClient::create(pool.get_executor(), settings_, recorder_.events());
  ASSERT_TRUE(created);
  created->start();
  for (std::size_t i = 1; i <= 50; ++i) {
    PeerConnection connection = peer_.accept();
    connection.send(cycle());
    ASSERT_TRUE(recorder_.wait_for_joints(i));
  }
  created->stop();
  EXPECT_EQ(recorder_.joints.back().sequence, 50u);
}

TEST(StateClient, RefusesPortsThatCommandTheRobot) {
  boost::asio::io_context context;
  for (const int port : {50240, 50242, 11000, 11003}) {
    StateClientSettings settings;
    settings.host = "127.0.0.1";
    settings.port = port;
    const auto created = StateClient::create(context.get_executor(), settings, {});
    ASSERT_FALSE(created) << port;
    EXPECT_EQ(created.error().code, RobotLinkError::port_commands_the_robot);
    EXPECT_EQ(created.error().detail, "robot.port = " + std::to_string(port));
  }
}

TEST(StateClient, RefusesSettingsNobodyCanMean) {
  const auto error_of = [](auto change) {
    StateClientSettings settings;
    settings.host = "controller";
    change(settings);
    const Status checked = check(settings);
    return checked ? std::error_code{} : checked.error().code;
  };
  EXPECT_FALSE(error_of([](auto&) {}));
  EXPECT_EQ(error_of([](auto& s) { s.host.clear(); }), RobotLinkError::host_missing);
  EXPECT_EQ(error_of([](auto& s) { s.port = 0; }), RobotLinkError::port_out_of_range);
  EXPECT_EQ(error_of([](auto& s) { s.port = 65536 + 50241; }), RobotLinkError::port_out_of_range);
  EXPECT_EQ(error_of([](auto& s) { s.real_bytes = 2; }), RobotLinkError::real_bytes_invalid);
  EXPECT_EQ(error_of([](auto& s) { s.group = 4; }), RobotLinkError::group_out_of_range);
  EXPECT_EQ(error_of([](auto& s) { s.joint_count = 11; }), RobotLinkError::joint_count_out_of_range);
  EXPECT_EQ(error_of([](auto& s) { s.max_position = -1; }), RobotLinkError::limit_invalid);
  EXPECT_EQ(error_of([](auto& s) { s.joint_ranges = {{1, -1}}; }), RobotLinkError::joint_range_invalid);
  EXPECT_EQ(error_of([](auto& s) { s.link.stale_after = 0ms; }), RobotLinkError::interval_invalid);
  EXPECT_EQ(error_of([](auto& s) { s.link.stale_after = 3s; }), RobotLinkError::interval_invalid);
}

}  // namespace
}  // namespace calibrd
