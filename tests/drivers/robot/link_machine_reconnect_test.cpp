// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_machine.hpp"
#include "tests/drivers/robot/link_machine_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using namespace wire;

TEST_F(LinkMachineTest, SilenceIsReportedThenEndsTheConnection) {
  start_and_connect();
  receive(state_cycle());
  pass(249ms);
  EXPECT_EQ(state(), State::streaming);
  pass(1ms);
  EXPECT_EQ(state(), State::silent);
  pass(1749ms);
  EXPECT_FALSE(asked_to<link_step::Close>());
  pass(1ms);
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_EQ(pause(), 50ms);
}

TEST_F(LinkMachineTest, AConnectionThatNeverSpeaksIsGivenUp) {
  start_and_connect();
  pass(250ms);
  EXPECT_EQ(state(), State::silent);
  pass(1750ms);
  EXPECT_TRUE(asked_to<link_step::Close>());
}

TEST_F(LinkMachineTest, BytesThatNeverEndAMessageAreSilence) {
  start_and_connect();
  const Bytes message = joints(0.1);
  for (std::size_t i = 0; i + 1 < message.size() && !asked_to<link_step::Close>(); ++i) {
    pass(20ms);
    if (!asked_to<link_step::Close>()) receive({message[i]});
  }
  EXPECT_TRUE(asked_to<link_step::Close>());
}

TEST_F(LinkMachineTest, AnEventThatFailsHalfWayStartsTheConnectionAnew) {
  start_and_connect();
  for (int i = 0; i < 3; ++i) {
    pass(10ms);
    obey(machine_.on_trouble("bad_alloc", now_));
    EXPECT_TRUE(asked_to<link_step::Close>());
    // Asked for again, though a timer was asked for before: nobody knows whether the shell has heard of it.
    EXPECT_TRUE(asked_to<link_step::ArmTimer>());
    EXPECT_TRUE(reason_is(RobotLinkError::out_of_resources));
  }
  EXPECT_EQ(pause(), 200ms);
  obey(machine_.stop());
  EXPECT_TRUE(machine_.on_trouble("bad_alloc", now_).empty());
}

TEST_F(LinkMachineTest, BacksOffAfterRefusalsUpToTheCap) {
  obey(machine_.start(now_));
  for (const auto expected : {50ms, 100ms, 200ms, 400ms, 500ms, 500ms}) {
    obey(machine_.on_connect_failed(std::make_error_code(std::errc::connection_refused), now_));
    EXPECT_EQ(state(), State::connecting);
    EXPECT_TRUE(reason_is(RobotLinkError::refused));
    EXPECT_EQ(pause(), expected);
  }
}

TEST_F(LinkMachineTest, GivesUpAnAttemptNobodyAnswers) {
  obey(machine_.start(now_));
  for (int attempt = 0; attempt < 5; ++attempt) {
    pass(899ms);
    EXPECT_FALSE(asked_to<link_step::Close>());
    pass(1ms);
    EXPECT_TRUE(asked_to<link_step::Close>());
    EXPECT_TRUE(reason_is(RobotLinkError::no_answer));
    EXPECT_EQ(pause(), 50ms) << "however many there were: the attempt itself was a pause";
  }
}

TEST_F(LinkMachineTest, ASettledConnectionMakesThePauseShortAgain) {
  obey(machine_.start(now_));
  for (int i = 0; i < 5; ++i) {
    obey(machine_.on_connect_failed(std::make_error_code(std::errc::connection_refused), now_));
    pause();
  }
  obey(machine_.on_connected(now_));
  stream_for(2500ms);
  obey(machine_.on_closed({}, now_));
  EXPECT_EQ(pause(), 50ms);
}

TEST_F(LinkMachineTest, RubbishAfterEveryConnectIsNotHammered) {
  obey(machine_.start(now_));
  for (const auto expected : {50ms, 100ms, 200ms, 400ms, 500ms, 500ms}) {
    obey(machine_.on_connected(now_));
    receive(state_cycle());
    receive(Bytes(16));
    EXPECT_TRUE(asked_to<link_step::Close>());
    EXPECT_EQ(pause(), expected);
  }
  EXPECT_EQ(machine_.health().framing_errors, 6u);
}

TEST_F(LinkMachineTest, TwoQuickClosesMeanAFightForSlots) {
  start_and_connect();
  stream_for(5s);  // the reference client comes back every 5 s
  obey(machine_.on_closed({}, now_));
  EXPECT_EQ(state(), State::connecting);
  EXPECT_TRUE(reason_is(RobotLinkError::closed_by_controller));
  EXPECT_EQ(pause(), 50ms);
  obey(machine_.on_connected(now_));
  stream_for(5s);
  obey(machine_.on_closed(std::make_error_code(std::errc::connection_reset), now_));
  EXPECT_EQ(state(), State::faulted);
  EXPECT_TRUE(reason_is(RobotLinkError::evicted));
  EXPECT_EQ(pause(), 30s);
  obey(machine_.on_connected(now_));
  obey(machine_.on_closed({}, now_));
  EXPECT_EQ(pause(), 30s) << "the fight goes on";
}

TEST_F(LinkMachineTest, AConnectionThatLastedEndsTheFight) {
  start_and_connect();
  obey(machine_.on_closed({}, now_));
  pause();
  obey(machine_.on_connected(now_));
  stream_for(10s);
  obey(machine_.on_closed({}, now_));
  EXPECT_EQ(pause(), 50ms);
  obey(machine_.on_connected(now_));
  obey(machine_.on_closed({}, now_));
  EXPECT_LE(pause(), 500ms);
}

TEST_F(LinkMachineTest, ARebootingControllerIsNoFight) {
  start_and_connect();
  obey(machine_.on_closed({}, now_));
  pause();
  obey(machine_.on_connect_failed(std::make_error_code(std::errc::connection_refused), now_));
  pause();
  obey(machine_.on_connected(now_));
  obey(machine_.on_closed({}, now_));
  EXPECT_LE(pause(), 500ms);
}

TEST_F(LinkMachineTest, AHeldUpProcessDropsJointsOfUnknownAge) {
  start_and_connect();
  receive(state_cycle());
  now_ += 10s;  // no tick either: the process did not run
  receive(state_cycle());
  EXPECT_EQ(joints_.size(), 1u);
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::held_up));
}

TEST_F(LinkMachineTest, AHeldUpProcessDoesNotBlameTheController) {
  start_and_connect();
  receive(state_cycle());
  now_ += 10s;
  obey(machine_.on_tick(now_));
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::held_up));
}

TEST_F(LinkMachineTest, ANewConnectionDoesNotLiveOnOldJoints) {
  start_and_connect();
  receive(state_cycle());
  obey(machine_.on_closed({}, now_));
  EXPECT_FALSE(machine_.health().status_fresh);
  EXPECT_EQ(pause(), 50ms);
  obey(machine_.on_connected(now_));
  EXPECT_EQ(state(), State::connecting);
  EXPECT_FALSE(machine_.health().status_fresh);
}

TEST_F(LinkMachineTest, KeepsTheWordsOfAnUnexplainedFailure) {
  obey(machine_.start(now_));
  const auto failure = std::make_error_code(std::errc::too_many_files_open);
  obey(machine_.on_connect_failed(failure, now_));
  EXPECT_TRUE(machine_.health().reason.starts_with(failure.message()));
}

TEST_F(LinkMachineTest, IgnoresLateEventsOfAnEndedConnection) {
  start_and_connect();
  obey(machine_.on_closed({}, now_));
  receive(state_cycle());
  obey(machine_.on_closed({}, now_));
  obey(machine_.on_connected(now_));
  EXPECT_TRUE(joints_.empty());
  EXPECT_EQ(machine_.health().connects, 1u);
}

TEST_F(LinkMachineTest, StopClosesAndIsFinal) {
  start_and_connect();
  obey(machine_.stop());
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::stopped));
  obey(machine_.stop());
  EXPECT_TRUE(last_.empty());
  receive(state_cycle());
  obey(machine_.on_tick(now_ + 60s));
  EXPECT_TRUE(last_.empty());
  EXPECT_TRUE(joints_.empty());
}

}  // namespace
}  // namespace calibrd
