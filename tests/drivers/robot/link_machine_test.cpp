// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/robot/robot_link_error.hpp"
#include "drivers/robot/simple_message/encode.hpp"
#include "drivers/robot/simple_message_codec.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using namespace simple_message;
using State = RobotLinkHealth::State;
using Bytes = std::vector<std::byte>;

constexpr WireFormat kBig{ByteOrder::big, 4};

Bytes topic(Body body, WireFormat format = kBig) {
  return encode({CommType::topic, ReplyCode::none, body}, format);
}
Bytes joints(double first) { return topic(JointFeedback{0, kValidPositions, 0, {first}, {}, {}}); }
Bytes status() { return topic(RobotStatus{1, 0, 0, 0, 0, 2, 1}); }
Bytes cycle() {
  Bytes bytes = joints(0.1);
  const Bytes more = status();
  bytes.insert(bytes.end(), more.begin(), more.end());
  return bytes;
}

/// A machine, its clock, and what it asked for.
class LinkMachineTest : public testing::Test {
 protected:
  void obey(const LinkSteps& steps) {
    last_ = steps;
    for (const LinkStep& step : steps) {
      if (const auto* timer = std::get_if<link_step::ArmTimer>(&step)) timer_ = timer->at;
      if (const auto* delivery = std::get_if<link_step::DeliverJoints>(&step))
        joints_.push_back(delivery->joints);
      if (const auto* delivery = std::get_if<link_step::DeliverStatus>(&step))
        statuses_.push_back(delivery->status);
      if (const auto* report = std::get_if<link_step::ReportHealth>(&step))
        reports_.push_back(report->health);
    }
  }
  template <class Step>
  bool asked_to() const {
    return std::ranges::any_of(last_,
                               [](const LinkStep& step) { return std::holds_alternative<Step>(step); });
  }
  void receive(const Bytes& bytes, bool more_waiting = false) {
    obey(machine_.on_received({bytes, now_, more_waiting}, now_));
  }
  /// Lets time pass; the timer fires whenever the machine asked for it. Stops early when it asks for a
  /// connection.
  void pass(std::chrono::milliseconds time) {
    const auto end = now_ + time;
    last_.clear();
    while (timer_ && *timer_ <= end) {
      now_ = std::max(now_, *timer_);
      timer_.reset();
      obey(machine_.on_tick(now_));
      if (asked_to<link_step::Connect>()) return;
    }
    now_ = end;
  }
  void start_and_connect() {
    obey(machine_.start(now_));
    obey(machine_.on_connected(now_));
  }
  void stream_for(std::chrono::milliseconds time) {
    for (const auto end = now_ + time; now_ < end; pass(25ms)) receive(cycle());
  }
  /// How long the machine pauses before it asks for the next connection.
  std::chrono::milliseconds pause() {
    const auto begin = now_;
    pass(60s);
    EXPECT_TRUE(asked_to<link_step::Connect>());
    return std::chrono::duration_cast<std::chrono::milliseconds>(now_ - begin);
  }
  State state() const { return machine_.health().state; }
  bool reason_is(const std::error_code& error) const {
    return machine_.health().reason.ends_with(error.message());
  }

  Clock::time_point now_{1000s};
  LinkMachine machine_{std::make_unique<SimpleMessageCodec>(SimpleMessageSettings{}), LinkSettings{}};
  LinkSteps last_;
  std::optional<Clock::time_point> timer_;
  std::vector<ControllerJoints> joints_;
  std::vector<ControllerStatus> statuses_;
  std::vector<RobotLinkHealth> reports_;
};

TEST_F(LinkMachineTest, ConnectsWhenStartedAndOnlyOnce) {
  obey(machine_.start(now_));
  EXPECT_TRUE(asked_to<link_step::Connect>());
  EXPECT_EQ(state(), State::connecting);
  obey(machine_.start(now_));
  EXPECT_TRUE(last_.empty());
}

TEST_F(LinkMachineTest, StreamsFromTheFirstJointsOn) {
  start_and_connect();
  receive(cycle());
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
  receive(cycle());
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
  receive(cycle());
  for (int i = 0; i < 10; ++i) {
    pass(25ms);
    receive(joints(0.1));
  }
  EXPECT_EQ(state(), State::streaming);
  EXPECT_FALSE(machine_.health().status_fresh);
  EXPECT_FALSE(reports_.back().status_fresh) << "the change is reported";
}

TEST_F(LinkMachineTest, SilenceIsReportedThenEndsTheConnection) {
  start_and_connect();
  receive(cycle());
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
  pass(1999ms);
  EXPECT_FALSE(asked_to<link_step::Close>());
  pass(1ms);
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::no_answer));
  EXPECT_EQ(pause(), 50ms);
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
    receive(cycle());
    receive(Bytes(16));
    EXPECT_TRUE(asked_to<link_step::Close>());
    EXPECT_EQ(pause(), expected);
  }
  EXPECT_EQ(machine_.health().framing_errors, 6u);
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
  receive(cycle());
  EXPECT_EQ(state(), State::streaming);
  EXPECT_EQ(machine_.health().reason, "");
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
  receive(cycle());
  now_ += 10s;  // no tick either: the process did not run
  receive(cycle());
  EXPECT_EQ(joints_.size(), 1u);
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::held_up));
}

TEST_F(LinkMachineTest, AHeldUpProcessDoesNotBlameTheController) {
  start_and_connect();
  receive(cycle());
  now_ += 10s;
  obey(machine_.on_tick(now_));
  EXPECT_TRUE(asked_to<link_step::Close>());
  EXPECT_TRUE(reason_is(RobotLinkError::held_up));
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
  receive(cycle());
  int armed = 0;
  for (int i = 0; i < 5; ++i) {
    receive(cycle());
    armed += asked_to<link_step::ArmTimer>();
    pass(25ms);
  }
  EXPECT_EQ(armed, 0);
}

TEST_F(LinkMachineTest, ANewConnectionDoesNotLiveOnOldJoints) {
  start_and_connect();
  receive(cycle());
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
  receive(cycle());
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
  receive(cycle());
  obey(machine_.on_tick(now_ + 60s));
  EXPECT_TRUE(last_.empty());
  EXPECT_TRUE(joints_.empty());
}

TEST(RobotLinkError, SaysWhatToDoForEveryCode) {
  for (int code = 1; code <= static_cast<int>(RobotLinkError::outside_joint_range); ++code) {
    EXPECT_NE(make_error_code(static_cast<RobotLinkError>(code)).message(), "unknown robot link error")
        << code;
  }
}

TEST(RobotLinkError, ExplainsWhatTheOperatingSystemSays) {
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::connection_refused)),
            RobotLinkError::refused);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::timed_out)), RobotLinkError::no_answer);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::host_unreachable)),
            RobotLinkError::unreachable);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::permission_denied)),
            RobotLinkError::connect_failed);
  EXPECT_EQ(explain_connect_failure(RobotLinkError::host_unknown), RobotLinkError::host_unknown);
}

}  // namespace
}  // namespace calibrd
