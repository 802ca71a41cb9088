// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/state_client.hpp"

#include <boost/asio/ip/tcp.hpp>

#include "tests/drivers/robot/state_client_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_EQ(recorder_.event_count(), 0u);
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

}  // namespace
}  // namespace calibrd
