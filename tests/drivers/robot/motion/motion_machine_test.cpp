// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_machine.hpp"

#include "tests/drivers/robot/motion/motion_fixture.hpp"

namespace calibrd {
namespace {

TEST_F(MotionMachineTest, VisitsEveryPostureHoldsAtEachAndLeavesTrajectoryModeAsItWas) {
  start_and_connect({{0.4, -0.2}, {0.0, 0.0}, {0.3, 0.3}});
  const auto begun = now_;
  pass_until([&] { return end_.has_value(); });
  EXPECT_FALSE(end_->error) << end_->error->message();
  EXPECT_EQ(reached_, 3u);
  EXPECT_EQ(robot_, (std::vector<double>{0.3F, 0.3F}));
  EXPECT_EQ(commands_, (std::vector<Post>{200101, 200121}));
  EXPECT_EQ(closes_, 1);
  EXPECT_GT(now_ - begun, 3 * settings_.hold);
}

TEST_F(MotionMachineTest, TheFirstPointIsWhereTheRobotIsAndSequencesCountUp) {
  start_and_connect({{0.4, -0.2}, {0.0, 0.0}});
  const auto here = robot_;
  pass_until([&] { return end_.has_value(); });
  std::int32_t expected = 0;
  int moves = 0;
  for (const auto& point : points_) {
    if (point.sequence == 0) {
      expected = 0;
      ++moves;
      EXPECT_EQ(point.time_s, 0);
      EXPECT_EQ(point.velocities, sm::JointValues{});
    }
    EXPECT_EQ(point.sequence, expected++);
  }
  EXPECT_EQ(moves, 2);
  EXPECT_NEAR(points_[0].positions[0], here[0], 1e-6);
  EXPECT_NEAR(points_[0].positions[1], here[1], 1e-6);
}

TEST_F(MotionMachineTest, PointsAreSentOnlyALittleAheadOfTheRobot) {
  start_and_connect();
  pass_until([&] {
    if (points_.size() > 1) {
      const double elapsed_s = std::chrono::duration<double>(now_ - began_).count();
      EXPECT_LE(points_.back().time_s, elapsed_s + 0.3 + 1e-6);
    }
    return end_.has_value();
  });
}

TEST_F(MotionMachineTest, APointThatFindsTheControllerBusyIsSentAgain) {
  int busy = 3;
  on_request_ = [&](sm::MotionReply& reply) {
    if (reply.command == 14 && reply.sequence == 5 && busy-- > 0) reply.result = 1;
  };
  start_and_connect();
  pass_until([&] { return end_.has_value(); });
  EXPECT_FALSE(end_->error) << end_->error->message();
  EXPECT_EQ(std::ranges::count(points_, 5, &sm::JointTrajectoryPointFull::sequence), 4);
}

TEST_F(MotionMachineTest, EveryCommandSaysWhatItIsAndWhy) {
  start_and_connect();
  pass_until_halfway();
  obey(machine_->stop(MotionError::stop_requested, now_));
  ASSERT_GT(said_.size(), 6u);
  EXPECT_EQ(said_.size(), commands_.size() + points_.size());
  EXPECT_NE(said_[0].find("check motion ready (200101)"), std::string::npos);
  EXPECT_NE(said_[2].find("trajectory point 1 of"), std::string::npos);
  EXPECT_NE(said_[said_.size() - 3].find("stop motion (200111), stopped on request"), std::string::npos);
}

TEST_F(MotionMachineTest, AnAnswerThatComesLateWhileItIsStoppedIsPassedOver) {
  start_and_connect();
  pass_until_halfway();
  answers_ = false;
  const auto before = points_.size();
  pass_until([&] { return points_.size() > before; });
  obey(machine_->stop(MotionError::stop_requested, now_));
  const auto answer = [&](std::int32_t command, std::int32_t sequence) {
    return sm::encode({sm::CommType::service_reply, sm::ReplyCode::success,
                       sm::MotionReply{0, sequence, command, 0, 0, {}}},
                      settings_.format);
  };
  auto both = answer(14, points_.back().sequence);
  const auto second = answer(200111, 3);
  both.insert(both.end(), second.begin(), second.end());
  answers_ = true;
  obey(machine_->on_received(both, now_));
  expect_stopped(MotionError::stop_requested);
}

TEST_F(MotionMachineTest, ARobotThatIsThereAlreadyStaysThere) {
  start_and_connect({{0.1, 0.2}});
  pass_until([&] { return end_.has_value(); });
  EXPECT_FALSE(end_->error) << end_->error->message();
}

TEST_F(MotionMachineTest, NothingHappensAfterTheEnd) {
  start_and_connect();
  obey(machine_->stop(MotionError::stop_requested, now_));
  ASSERT_TRUE(end_);
  EXPECT_TRUE(machine_->on_tick(now_).empty());
  EXPECT_TRUE(machine_->on_watch(now_).empty());
  EXPECT_TRUE(machine_->on_closed({}, now_).empty());
  EXPECT_TRUE(machine_->stop(MotionError::daemon_ends, now_).empty());
}

}  // namespace
}  // namespace calibrd
