// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_error.hpp"
#include "tests/drivers/robot/motion/motion_fixture.hpp"

namespace calibrd {
namespace {

/// A change of the status, and what it must be taken for.
struct BadStatus {
  const char* name;
  MotionError doubt;
  void (*change)(ControllerStatus&);
};

constexpr BadStatus kBadStatuses[] = {
    {"emergency_stop", MotionError::e_stopped, [](auto& s) { s.e_stopped = true; }},
    {"emergency_stop_unknown", MotionError::e_stopped, [](auto& s) { s.e_stopped.reset(); }},
    {"alarm", MotionError::in_error, [](auto& s) { s.in_error = true; }},
    {"alarm_unknown", MotionError::in_error, [](auto& s) { s.in_error.reset(); }},
    {"manual", MotionError::not_automatic, [](auto& s) { s.mode = ControllerStatus::Mode::manual; }},
    {"mode_unknown", MotionError::not_automatic, [](auto& s) { s.mode = ControllerStatus::Mode::unknown; }},
    {"drives_off", MotionError::drives_off, [](auto& s) { s.drives_powered = false; }},
    {"drives_unknown", MotionError::drives_off, [](auto& s) { s.drives_powered.reset(); }},
    {"motion_not_possible", MotionError::motion_not_possible, [](auto& s) { s.motion_possible = false; }},
    {"motion_unknown", MotionError::motion_not_possible, [](auto& s) { s.motion_possible.reset(); }},
};

class EveryBadStatus : public MotionMachineTest, public testing::WithParamInterface<BadStatus> {};

TEST_P(EveryBadStatus, RefusesToBegin) {
  change_status_ = GetParam().change;
  pass(25ms);
  start();
  expect_refused(GetParam().doubt);
}

TEST_P(EveryBadStatus, StopsTheMovingRobotAtTheNextStatus) {
  start_and_connect();
  pass_until_halfway();
  change_status_ = GetParam().change;
  pass(25ms);
  expect_stopped(GetParam().doubt);
}

TEST_P(EveryBadStatus, StopsWhileThePostureIsHeld) {
  start_and_connect();
  pass_until([&] { return reached_ == 1; });
  change_status_ = GetParam().change;
  pass(25ms);
  expect_stopped(GetParam().doubt);
}

INSTANTIATE_TEST_SUITE_P(Status, EveryBadStatus, testing::ValuesIn(kBadStatuses),
                         [](const auto& info) { return info.param.name; });

using MotionDoubts = MotionMachineTest;

TEST_F(MotionDoubts, ARobotThatSomebodyMovesIsLeftAlone) {
  change_status_ = [](auto& status) { status.in_motion = true; };
  pass(25ms);
  start();
  expect_refused(MotionError::in_motion);
}

TEST_F(MotionDoubts, ARobotOfWhichNobodyKnowsWhetherItMovesIsLeftAlone) {
  change_status_ = [](auto& status) { status.in_motion.reset(); };
  pass(25ms);
  start();
  expect_refused(MotionError::in_motion);
}

TEST_F(MotionDoubts, ARobotThatHasOnlyJustStoppedIsLeftAlone) {
  robot_[1] += 0.05;
  pass(25ms);
  start();
  expect_refused(MotionError::not_at_rest);
}

TEST_F(MotionDoubts, ARobotThatIsNotWhereItsWayWasCheckedFromIsLeftAlone) {
  machine_.emplace(MotionOrder{{0.3, 0.2}, {{0.4, -0.2}}}, settings_, watch_);
  obey(machine_->start(now_));
  expect_refused(MotionError::moved_since_checked);
}

TEST_F(MotionDoubts, NothingBeginsWithoutFreshJoints) {
  joints_come_ = false;
  for (int i = 0; i < 20; ++i) pass(25ms);
  start();
  expect_refused(MotionError::joints_stale);
}

TEST_F(MotionDoubts, NothingBeginsWithoutAFreshStatus) {
  status_comes_ = false;
  for (int i = 0; i < 20; ++i) pass(25ms);
  start();
  expect_refused(MotionError::status_stale);
}

TEST_F(MotionDoubts, NothingBeginsWhileTheStateLinkIsDown) {
  RobotLinkHealth health;
  health.state = RobotLinkHealth::State::faulted;
  watch_.take(health);
  start();
  expect_refused(MotionError::link_down);
}

TEST_F(MotionDoubts, MotionByAnotherHandBeforeTheFirstPointStopsIt) {
  answers_ = false;
  start_and_connect();
  change_status_ = [](auto& status) { status.in_motion = true; };
  answers_ = true;
  on_request_ = [](auto& reply) { reply.sequence = 2; };
  pass(25ms);
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::in_motion);
}

TEST_F(MotionDoubts, JointsThatStopComingStopTheRobotWithin300Ms) {
  start_and_connect();
  pass_until_halfway();
  joints_come_ = false;
  const auto lost = now_;
  pass_until([&] { return end_.has_value(); });
  EXPECT_LE(now_ - lost, 300ms);
  expect_stopped(MotionError::joints_stale);
}

TEST_F(MotionDoubts, AStatusThatStopsComingStopsTheRobotWithin300Ms) {
  start_and_connect();
  pass_until_halfway();
  status_comes_ = false;
  const auto lost = now_;
  pass_until([&] { return end_.has_value(); });
  EXPECT_LE(now_ - lost, 300ms);
  expect_stopped(MotionError::status_stale);
}

TEST_F(MotionDoubts, FrozenJointsWithLiveStatusStopTheRobot) {
  start_and_connect();
  pass_until_halfway();
  follows_ = false;
  pass_until([&] { return end_.has_value(); }, 3s);
  expect_stopped(MotionError::off_path);
}

TEST_F(MotionDoubts, AJointThatLeavesThePathStopsTheRobotAtOnce) {
  start_and_connect({{0.7, 0.2}});
  pass_until_halfway();
  queue_.clear();
  robot_[1] += 0.05;
  pass(25ms);
  expect_stopped(MotionError::off_path);
  EXPECT_NE(end_->error->detail.find("joint 2 is"), std::string::npos) << end_->error->detail;
}

TEST_F(MotionDoubts, ARobotThatRunsAheadStopsIt) {
  settings_.limits = {1, 2};
  start_and_connect({{2.0, -0.2}});
  pass_until_halfway();
  began_ -= 400ms;
  pass(25ms);
  expect_stopped(MotionError::off_path);
}

TEST_F(MotionDoubts, ARobotPushedAwayWhileItHoldsStopsIt) {
  start_and_connect();
  pass_until([&] { return reached_ == 1; });
  queue_.clear();
  robot_[0] += 0.03;
  pass(25ms);
  expect_stopped(MotionError::off_path);
}

TEST_F(MotionDoubts, ARobotThatDoesNotComeToRestStopsIt) {
  start_and_connect();
  change_status_ = [](auto& status) { status.in_motion = true; };
  pass_until([&] { return end_.has_value(); });
  expect_stopped(MotionError::not_arrived);
}

TEST_F(MotionDoubts, TheStateLinkGoingDownStopsIt) {
  start_and_connect();
  pass_until_halfway();
  RobotLinkHealth health;
  health.state = RobotLinkHealth::State::connecting;
  watch_.take(health);
  obey(machine_->on_watch(now_));
  expect_stopped(MotionError::link_down);
}

TEST_F(MotionDoubts, AProcessThatWasHeldUpStopsTheRobot) {
  start_and_connect();
  pass_until_halfway();
  pass(400ms);
  expect_stopped(MotionError::held_up);
}

TEST_F(MotionDoubts, AStopBeforeThePortIsOpenOpensNothing) {
  start();
  obey(machine_->stop(MotionError::daemon_ends, now_));
  ASSERT_TRUE(end_ && end_->error);
  EXPECT_EQ(end_->error->code, MotionError::daemon_ends);
  EXPECT_TRUE(commands_.empty());
  EXPECT_TRUE(machine_->on_connected(now_).empty());
}

}  // namespace
}  // namespace calibrd
