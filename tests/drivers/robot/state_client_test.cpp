// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/state_client.hpp"

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <optional>
#include <thread>

#include "drivers/robot/robot_link_error.hpp"
#include "tests/drivers/robot/state_peer.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using State = RobotLinkHealth::State;
using Bytes = std::vector<std::byte>;

/// One cycle of joints and status as a live server sent it, big endian.
const Bytes& cycle() {
  static const Bytes bytes = simple_message::live_first_cycle("bswap/feedback");
  return bytes;
}

/// A client with short times on a thread of its own, and the controller it talks to.
class StateClientTest : public testing::Test {
 protected:
  StateClientTest() {
    settings_.host = "127.0.0.1";
    settings_.port = peer_.port();
    settings_.joint_count = 7;
    settings_.link.stale_after = 100ms;
    settings_.link.reconnect_after = 300ms;
    settings_.link.connect_timeout = 300ms;
    settings_.link.backoff_first = 2ms;
    settings_.link.backoff_cap = 10ms;
    settings_.link.eviction_within = 0ms;
  }
  ~StateClientTest() override {
    client_.reset();
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }
  void start() {
    auto created = StateClient::create(context_.get_executor(), settings_, recorder_.events());
    ASSERT_TRUE(created) << created.error().message();
    client_.emplace(std::move(*created));
    client_->start();
    thread_ = std::thread([this] {
      const auto work = boost::asio::make_work_guard(context_);
      context_.run();
    });
  }
  /// stop() returns within 100 ms and nothing is told afterwards.
  void expect_prompt_stop() {
    const auto begin = Clock::now();
    client_->stop();
    EXPECT_LT(Clock::now() - begin, 100ms);
    const std::size_t told = recorder_.event_count();
    client_->stop();
    EXPECT_FALSE(peer_.somebody_connects_within(50ms));
    EXPECT_EQ(recorder_.event_count(), told);
  }
  bool wait_for_reason(RobotLinkError error) {
    const std::string reason = make_error_code(error).message();
    return recorder_.wait_for(
        [&] { return !recorder_.reports.empty() && recorder_.reports.back().reason.ends_with(reason); });
  }

  StatePeer peer_;
  StateClientSettings settings_;
  LinkRecorder recorder_;
  boost::asio::io_context context_;
  std::optional<StateClient> client_;
  std::thread thread_;
};

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
  for (std::size_t count = 2; client_->health().state != State::joints_stale; ++count) {
    connection.send(status);
    ASSERT_TRUE(recorder_.wait_for([&] { return recorder_.statuses.size() >= count; }));
  }
  EXPECT_TRUE(client_->health().status_fresh);
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
  ASSERT_TRUE(recorder_.wait_for_state(State::streaming));
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

TEST_F(StateClientTest, StopsWhileItStreams) {
  start();
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_joints(1));
  expect_prompt_stop();
}

TEST_F(StateClientTest, StopsWhileThePeerIsSilent) {
  settings_.link.reconnect_after = 60s;
  start();
  PeerConnection connection = peer_.accept();
  ASSERT_TRUE(recorder_.wait_for_state(State::silent));
  expect_prompt_stop();
}

TEST_F(StateClientTest, StopsWhileItPausesBetweenAttempts) {
  settings_.link.backoff_first = settings_.link.backoff_cap = 60s;
  peer_.stop_listening();
  start();
  ASSERT_TRUE(wait_for_reason(RobotLinkError::refused));
  peer_.listen_again();
  expect_prompt_stop();
}

TEST_F(StateClientTest, StopsBeforeItsExecutorEverRan) {
  auto created = StateClient::create(context_.get_executor(), settings_, recorder_.events());
  ASSERT_TRUE(created);
  created->start();
  created->stop();
  context_.run();
  EXPECT_EQ(recorder_.event_count(), 1u) << "connecting, told by start()";
  EXPECT_FALSE(peer_.somebody_connects_within(0ms));
}

TEST_F(StateClientTest, MayBeStoppedByItsOwnHandler) {
  RobotLinkEvents events = recorder_.events();
  events.on_joints = [&, record = events.on_joints](const ControllerJoints& joints) {
    client_->stop();
    record(joints);
  };
  auto created = StateClient::create(context_.get_executor(), settings_, events);
  ASSERT_TRUE(created);
  client_.emplace(std::move(*created));
  client_->start();
  thread_ = std::thread([this] { context_.run(); });
  PeerConnection connection = peer_.accept();
  connection.send(cycle());
  ASSERT_TRUE(recorder_.wait_for_joints(1));
  EXPECT_TRUE(connection.client_closes_without_a_word());
  thread_.join();
  EXPECT_TRUE(recorder_.reports.size() == 1) << "nothing after stop()";
}

/// A listener whose queue is full drops connection requests: no answer comes, as from a host that is switched
/// off.
class DeafControllerTest : public StateClientTest {
 protected:
  DeafControllerTest() {
    settings_.port = deaf_.port();
    waiting_.connect({boost::asio::ip::address_v4::loopback(), deaf_.port()});
  }
  StatePeer deaf_{0};
  boost::asio::io_context unused_;
  boost::asio::ip::tcp::socket waiting_{unused_};
};

TEST_F(DeafControllerTest, GivesUpAnAttemptAndSaysSo) {
  start();
  EXPECT_TRUE(wait_for_reason(RobotLinkError::no_answer));
}

TEST_F(DeafControllerTest, StopsWhileItConnects) {
  settings_.link.connect_timeout = 60s;
  start();
  ASSERT_TRUE(recorder_.wait_for_state(State::connecting));
  expect_prompt_stop();
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
