// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_error.hpp"
#include "tests/drivers/robot/motion/motion_fixture.hpp"

/// What the motion port answers, or does not.
namespace calibrd {
namespace {

using MotionAnswers = MotionMachineTest;

TEST_F(MotionAnswers, AControllerThatIsNotReadyIsNotCommanded) {
  on_request_ = [](auto& reply) {
    if (reply.command == 200101) reply = {0, reply.sequence, 200101, 2, 5008, {}};
  };
  start_and_connect();
  expect_stopped(MotionError::refused_by_controller);
  EXPECT_TRUE(points_.empty());
  EXPECT_NE(end_->error->detail.find("the ROS job is not started (5008)"), std::string::npos);
}

TEST_F(MotionAnswers, TrajectoryModeRefusedEndsIt) {
  on_request_ = [](auto& reply) {
    if (reply.command == 200121) reply = {0, reply.sequence, 200121, 5, 5005, {}};
  };
  start_and_connect();
  expect_stopped(MotionError::refused_by_controller);
  EXPECT_TRUE(points_.empty());
}

TEST_F(MotionAnswers, AnyOtherResultOfAPointStopsTheRobot) {
  for (const std::int32_t result : {2, 3, 4, 5, 6, 99}) {
    end_.reset();
    points_.clear();
    queue_.clear();
    closes_ = 0;
    on_request_ = [&](auto& reply) {
      if (reply.command == 14 && reply.sequence == 7) reply.result = result;
    };
    for (int i = 0; i < 60; ++i) pass(25ms);
    start_and_connect({{robot_[0] + 0.3, robot_[1]}});
    pass_until([&] { return end_.has_value(); });
    expect_stopped(MotionError::refused_by_controller);
    machine_.reset();
  }
}

TEST_F(MotionAnswers, AControllerThatStaysBusyEndsIt) {
  on_request_ = [](auto& reply) {
    if (reply.command == 14 && reply.sequence >= 4) reply.result = 1;
  };
  settings_.path.lag = 10s;
  start_and_connect();
  pass_until([&] { return end_.has_value(); });
  expect_stopped(MotionError::busy_too_long);
}

TEST_F(MotionAnswers, APointWithoutAnAnswerStopsTheRobotAndThePortIsClosedWhenThatIsNotAnsweredEither) {
  start_and_connect();
  pass_until_halfway();
  answers_ = false;
  settings_.path.lag = 10s;
  const auto silent = now_;
  pass_until([&] { return end_.has_value(); });
  EXPECT_LE(now_ - silent, 2s);
  EXPECT_EQ(commands_.back(), 200111);
  EXPECT_EQ(closes_, 1);
}

TEST_F(MotionAnswers, AnAnswerToSomethingElseStopsTheRobot) {
  on_request_ = [](auto& reply) {
    if (reply.command == 14 && reply.sequence == 7) reply.sequence = 6;
  };
  start_and_connect();
  pass_until([&] { return end_.has_value(); });
  EXPECT_EQ(end_->error->code, MotionError::reply_unreadable);
  EXPECT_EQ(closes_, 1);
}

TEST_F(MotionAnswers, RubbishFromTheControllerClosesThePort) {
  start_and_connect();
  pass_until_halfway();
  const std::vector<std::byte> rubbish(64, std::byte{0xff});
  obey(machine_->on_received(rubbish, now_));
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::reply_unreadable);
  EXPECT_EQ(closes_, 1);
}

TEST_F(MotionAnswers, APortThatIsClosedByTheControllerEndsIt) {
  start_and_connect();
  pass_until_halfway();
  obey(machine_->on_closed({}, now_));
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::closed_by_controller);
}

TEST_F(MotionAnswers, APortThatDoesNotOpenIsGivenUp) {
  start();
  pass_until([&] { return end_.has_value(); });
  EXPECT_EQ(end_->error->code, MotionError::connect_failed);
  EXPECT_TRUE(commands_.empty());
  EXPECT_EQ(closes_, 1);
}

TEST_F(MotionAnswers, ARefusedConnectionEndsIt) {
  start();
  obey(machine_->on_connect_failed(std::make_error_code(std::errc::connection_refused), now_));
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::connect_failed);
}

TEST_F(MotionAnswers, AStopThatIsRefusedClosesThePortAtOnce) {
  start_and_connect();
  pass_until_halfway();
  on_request_ = [](auto& reply) {
    if (reply.command == 200111) reply.result = 2;
  };
  obey(machine_->stop(MotionError::stop_requested, now_));
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::stop_requested);
  EXPECT_EQ(commands_.back(), 200111);
  EXPECT_EQ(closes_, 1);
}

}  // namespace
}  // namespace calibrd
