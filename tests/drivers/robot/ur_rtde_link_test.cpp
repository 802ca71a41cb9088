// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// RTDE under the link machine, and over a real socket.
#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/ur_rtde_codec.hpp"
#include "tests/drivers/robot/link_machine_fixture.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"
#include "tests/drivers/robot/state_client_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using rtde::RtdeError;

class UrRtdeMachineTest : public LinkMachineTest {
 protected:
  UrRtdeMachineTest() {
    machine_ = LinkMachine(std::make_unique<UrRtdeCodec>(UrRtdeSettings{}), LinkSettings{});
    start_and_connect();
  }
};

TEST_F(UrRtdeMachineTest, SpeaksFirstAndAnswersEveryReply) {
  EXPECT_TRUE(asked_to<link_step::Send>());
  receive(rtde_bytes::accepted('V'));
  EXPECT_TRUE(asked_to<link_step::Send>());
  receive(rtde_bytes::controller_version());
  receive(rtde_bytes::outputs(1));
  receive(rtde_bytes::accepted('S'));
  EXPECT_FALSE(asked_to<link_step::Send>());
  receive(rtde_bytes::data());
  EXPECT_EQ(state(), State::streaming);
  EXPECT_EQ(joints_.size(), 1U);
}

TEST_F(UrRtdeMachineTest, AHandshakeThatNeverEndsIsSilence) {
  receive(rtde_bytes::accepted('V'));
  for (int i = 0; i < 19; ++i) {  // texts do not keep it alive
    pass(100ms);
    ASSERT_FALSE(asked_to<link_step::Connect>());
    receive(rtde_bytes::text_message("still booting"));
  }
  EXPECT_EQ(state(), State::silent);
  pass(300ms);
  EXPECT_TRUE(asked_to<link_step::Connect>());
}

TEST_F(UrRtdeMachineTest, ASlowHandshakeIsCalledOne) {
  receive(rtde_bytes::accepted('V'));
  pass(200ms);
  receive(rtde_bytes::controller_version());
  pass(100ms);
  EXPECT_EQ(state(), State::joints_stale);
  EXPECT_TRUE(reason_is(RtdeError::handshake_unfinished)) << machine_.health().reason;
}

TEST_F(UrRtdeMachineTest, AStreamThatStopsIsSilenceWhateverTextsCome) {
  receive(rtde_bytes::handshake());
  receive(rtde_bytes::data());
  bool connects = false;
  for (int i = 0; i < 25 && !connects; ++i) {
    pass(100ms);
    connects = asked_to<link_step::Connect>();
    if (!connects) receive(rtde_bytes::text_message("paused"));
  }
  EXPECT_TRUE(connects);
}

TEST_F(UrRtdeMachineTest, AFrozenControllerIsNotStreaming) {
  receive(rtde_bytes::handshake());
  for (int i = 0; i < 60; ++i) {
    receive(rtde_bytes::data());
    pass(8ms);
  }
  EXPECT_EQ(state(), State::joints_stale);
  EXPECT_TRUE(reason_is(RtdeError::clock_stands_still)) << machine_.health().reason;
  EXPECT_TRUE(machine_.health().status_fresh);
  EXPECT_EQ(joints_.size(), 1U);
}

TEST_F(UrRtdeMachineTest, AVariableThatIsNotFoundIsAFaultThatIsNotHammered) {
  receive(rtde_bytes::accepted('V'));
  receive(rtde_bytes::controller_version());
  receive(rtde_bytes::outputs(0, "DOUBLE,NOT_FOUND,VECTOR6D,INT32,UINT32"));
  EXPECT_EQ(state(), State::faulted);
  EXPECT_TRUE(reason_is(RtdeError::variable_not_found));
  EXPECT_NE(machine_.health().reason.find("actual_q"), std::string::npos);
  EXPECT_GE(pause(), 50ms);
}

/// A controller over a real socket, speaking after it was spoken to.
class UrRtdeClientTest : public StateClientTest {
 protected:
  UrRtdeClientTest() {
    settings_.driver = "ur_rtde";
    settings_.joint_count = 6;
  }
  static void expect_request(PeerConnection& connection, const rtde_bytes::Bytes& request) {
    EXPECT_EQ(connection.receive(request.size()), request);
  }
  static void greet(PeerConnection& connection) {
    expect_request(connection, rtde_bytes::hex("0005560002"));
    connection.send(rtde_bytes::accepted('V'));
    expect_request(connection, rtde_bytes::hex("000376"));
    connection.send_byte_by_byte(rtde_bytes::controller_version());
    expect_request(connection,
                   rtde_bytes::package(
                       'O', rtde_bytes::operator+(rtde_bytes::real(125),
                                                  rtde_bytes::text("timestamp,actual_q,actual_qd,robot_mode,"
                                                                   "safety_status_bits"))));
    connection.send_byte_by_byte(rtde_bytes::outputs(3));
    expect_request(connection, rtde_bytes::hex("000353"));
    connection.send(rtde_bytes::accepted('S'));
  }
};

TEST_F(UrRtdeClientTest, DeliversJointsAndStatus) {
  start();
  PeerConnection connection = peer_.accept();
  greet(connection);
  connection.send_byte_by_byte(rtde_bytes::data({}, 3));
  ASSERT_TRUE(recorder_.wait_for([&] { return !recorder_.joints.empty() && !recorder_.statuses.empty(); }));
  client_->stop();
  EXPECT_EQ(recorder_.joints[0].positions_rad, (std::vector<double>{0.1, -0.2, 0.3, -0.4, 0.5, -0.6}));
  EXPECT_TRUE(connection.client_closes_without_a_word()) << "nothing is sent but the handshake";
}

TEST_F(UrRtdeClientTest, MakesTheHandshakeAgainAfterADrop) {
  start();
  for (std::size_t i = 1; i <= 3; ++i) {
    PeerConnection connection = peer_.accept();
    greet(connection);
    connection.send(rtde_bytes::data({}, 3));
    ASSERT_TRUE(recorder_.wait_for_joints(i));
    if (i == 2) connection.reset();
  }
}

TEST_F(UrRtdeClientTest, ComesBackWhenTheControllerDoesNotAnswer) {
  start();
  PeerConnection mute = peer_.accept();
  ASSERT_TRUE(recorder_.wait_for_state(State::silent));
  PeerConnection connection = peer_.accept();
  greet(connection);
  connection.send(rtde_bytes::data({}, 3));
  EXPECT_TRUE(recorder_.wait_for_joints(1));
}

}  // namespace
}  // namespace calibrd
