// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_machine.hpp"

#include <limits>

#include "tests/drivers/robot/link_machine_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using namespace wire;

TEST_F(LinkMachineTest, ConnectsWhenStartedAndOnlyOnce) {
  obey(machine_.start(now_));
  EXPECT_TRUE(asked_to<link_step::Connect>());
  EXPECT_EQ(state(), State::connecting);
  obey(machine_.start(now_));
  EXPECT_TRUE(last_.empty());
}

TEST_F(LinkMachineTest, StreamsFromTheFirstJointsOn) {
  start_and_connect();
  receive(state_cycle());
  EXPECT_EQ(state(), State::streaming);
  EXPECT_EQ(machine_.health().reason, "");
  EXPECT_TRUE(machine_.health().status_fresh);
  ASSERT_EQ(joints_.size(), 1u);
  EXPECT_EQ(joints_[0].sequence, 1u);
  EXPECT_EQ(joints_[0].stamp, now_);
  EXPECT_EQ(statuses_.size(), 1u);
}

TEST_F(LinkMachineTest, SequenceCountsMessagesAcrossConnections) {
  start_and_connect();
  receive(joints(0.1));
  receive(joints(0.1));
  obey(machine_.on_closed({}, now_));
  pass(60s);
  obey(machine_.on_connected(now_));
  receive(joints(0.1));
  ASSERT_EQ(joints_.size(), 3u);
  EXPECT_EQ(joints_[2].sequence, 3u);
}

TEST_F(LinkMachineTest, DeliversNothingOnTimersOrOtherMessages) {
  start_and_connect();
  receive(joints(0.1));
  receive(status());
  pass(1500ms);
  EXPECT_EQ(joints_.size(), 1u);
}

TEST_F(LinkMachineTest, AStillRobotIsNotStale) {
  start_and_connect();
  stream_for(2500ms);
  EXPECT_EQ(state(), State::streaming);
  EXPECT_EQ(joints_.size(), 100u);
  EXPECT_EQ(joints_.back().sequence, 100u);
}

TEST_F(LinkMachineTest, DeliversOnlyTheNewestJointsOfABacklogUnderTheirOwnStamp) {
  start_and_connect();
  receive(joints(0.1), true);
  pass(1ms);
  receive(joints(0.2), true);
  EXPECT_TRUE(joints_.empty());
  pass(1ms);
  receive(joints(0.3), false);
  ASSERT_EQ(joints_.size(), 1u);
  EXPECT_FLOAT_EQ(static_cast<float>(joints_[0].positions_rad[0]), 0.3F);
  EXPECT_EQ(joints_[0].sequence, 3u);
  EXPECT_EQ(joints_[0].stamp, now_);
}

TEST_F(LinkMachineTest, OldJointsDeliveredLateAreStaleAtOnce) {
  start_and_connect();
  pass(300ms);
  obey(machine_.on_received({joints(0.1), now_ - 260ms}, now_));
  EXPECT_EQ(joints_.at(0).stamp, now_ - 260ms);
  EXPECT_EQ(state(), State::joints_stale);
}

TEST_F(LinkMachineTest, StatusAloneMakesJointsStaleAfterATimeOut) {
  start_and_connect();
  receive(state_cycle());
  for (int i = 0; i < 9; ++i) {
    pass(25ms);
    receive(status());
  }
  EXPECT_EQ(state(), State::streaming);
  pass(25ms);
  EXPECT_EQ(state(), State::joints_stale);
  EXPECT_TRUE(reason_is(RobotLinkError::joints_missing));
  EXPECT_TRUE(machine_.health().status_fresh);
}

TEST_F(LinkMachineTest, StatusAloneNeverMakesItReconnect) {
  start_and_connect();
  for (int i = 0; i < 400; ++i) {
    receive(status());
    pass(25ms);
  }
  EXPECT_EQ(machine_.health().connects, 1u);
  EXPECT_EQ(state(), State::joints_stale);
  receive(joints(0.1));
  EXPECT_EQ(state(), State::streaming);
}

TEST_F(LinkMachineTest, JointsAloneMakeTheStatusStale) {
  start_and_connect();
  receive(state_cycle());
  for (int i = 0; i < 10; ++i) {
    pass(25ms);
    receive(joints(0.1));
  }
  EXPECT_EQ(state(), State::streaming);
  EXPECT_FALSE(machine_.health().status_fresh);
  EXPECT_FALSE(reports_.back().status_fresh) << "the change is reported";
}

TEST_F(LinkMachineTest, NamesTheByteOrderToConfigureUntilTheStreamIsRead) {
  start_and_connect();
  receive(topic(JointFeedback{}, {ByteOrder::little, 4}));
  const std::string expected =
      "peer sends little endian, big is configured: set robot.byte_order = \"little\"";
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_EQ(state(), State::faulted);
  EXPECT_EQ(machine_.health().reason, expected);
  pause();
  EXPECT_EQ(machine_.health().reason, expected) << "while it waits";
  obey(machine_.on_connected(now_));
  EXPECT_EQ(machine_.health().reason, expected) << "while nothing has come";
  receive(state_cycle());
  EXPECT_EQ(state(), State::streaming);
  EXPECT_EQ(machine_.health().reason, "");
}

TEST_F(LinkMachineTest, SaysWhichJointIsNotANumber) {
  start_and_connect();
  JointFeedback bad{0, kValidPositions, 0, {}, {}, {}};
  bad.positions[2] = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 12; ++i) {
    receive(topic(bad));
    pass(25ms);
  }
  EXPECT_TRUE(joints_.empty());
  EXPECT_EQ(state(), State::joints_stale);
  EXPECT_TRUE(machine_.health().reason.starts_with("position of joint 3")) << machine_.health().reason;
  EXPECT_EQ(machine_.health().rejected_values, 12u);
}

TEST_F(LinkMachineTest, SaysWhichGroupTheControllerSends) {
  start_and_connect();
  for (int i = 0; i < 12; ++i) {
    receive(topic(JointFeedback{1, kValidPositions, 0, {}, {}, {}}));
    pass(25ms);
  }
  EXPECT_EQ(state(), State::joints_stale);
  EXPECT_TRUE(reason_is(RobotLinkError::only_other_groups));
  EXPECT_EQ(machine_.health().other_group, 12u);
}

TEST_F(LinkMachineTest, ReportsHealthOnChangesOnly) {
  start_and_connect();
  stream_for(2500ms);
  EXPECT_EQ(reports_.size(), 2u) << "connecting, streaming";
}

TEST_F(LinkMachineTest, DoesNotArmTheTimerWithEveryMessage) {
  start_and_connect();
  receive(state_cycle());
  int armed = 0;
  for (int i = 0; i < 5; ++i) {
    receive(state_cycle());
    armed += asked_to<link_step::ArmTimer>();
    pass(25ms);
  }
  EXPECT_EQ(armed, 0);
}

}  // namespace
}  // namespace calibrd
