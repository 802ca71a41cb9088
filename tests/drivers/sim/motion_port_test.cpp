// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/sim/controller/cycle.hpp"
#include "drivers/sim/controller/motion_commands.hpp"

namespace calibrd::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// The motion port without sockets: a robot of two joints at (0.1, 0.2), and a clock.
class MotionPort : public testing::Test {
 protected:
  MotionPort() {
    world_.joint_count = 2;
    world_.motion.place(Joints{0.1, 0.2}, now_ns_);
  }
  MotionReplyRecord command(std::int32_t command) {
    return commands_.obey({MotionRequest::kControl, 0, 5, command, 0, 0, {}, {}}, world_, settings_, now_ns_)
        .reply;
  }
  MotionReplyRecord point(std::int32_t sequence, double time_s, double first, double speed = 0) {
    return commands_
        .obey({MotionRequest::kPoint, 0, sequence, 0, 15, time_s, {first, 0.2}, {speed, 0}}, world_,
              settings_, now_ns_)
        .reply;
  }
  double first_joint() const { return world_.motion.positions_at(now_ns_)[0]; }

  std::int64_t now_ns_ = 5'000 * kMs;
  WorldState world_;
  ControllerSettings settings_;
  MotionCommands commands_;
};

TEST_F(MotionPort, PointsMoveTheRobotAlongTheirCubic) {
  EXPECT_EQ(point(0, 0, 0.1).result, 0);
  EXPECT_EQ(point(1, 0.1, 0.11, 0.1).result, 0);
  EXPECT_EQ(point(2, 0.2, 0.12, 0).result, 0);
  now_ns_ += 100 * kMs;
  EXPECT_NEAR(first_joint(), 0.11, 1e-9);
  EXPECT_NEAR(world_.motion.velocities_at(now_ns_)[0], 0.1, 0.02);
  now_ns_ += 500 * kMs;
  EXPECT_NEAR(first_joint(), 0.12, 1e-9);
}

TEST_F(MotionPort, TheFirstPointMustBeWhereTheRobotIs) {
  const auto reply = point(0, 0, 0.102);
  EXPECT_EQ(reply.result, 3);
  EXPECT_EQ(reply.subcode, 3011);
}

TEST_F(MotionPort, TheFirstPointIsWhereTheControllerReportsTheRobot) {
  world_.joint_zero_rad[0] = 0.01;
  EXPECT_EQ(point(0, 0, 0.09).result, 0);
  EXPECT_EQ(point(1, 0.1, 0.10).result, 0);
  now_ns_ += 200 * kMs;
  EXPECT_NEAR(first_joint(), 0.11, 1e-9);
  EXPECT_NEAR(world_.reported_at(now_ns_)[0], 0.10, 1e-9);
}

TEST_F(MotionPort, AFullQueueIsBusy) {
  EXPECT_EQ(point(0, 0, 0.1).result, 0);
  EXPECT_EQ(point(1, 0.9, 0.2).result, 0);
  EXPECT_EQ(point(2, 1.0, 0.2).result, 1);
  now_ns_ += 200 * kMs;
  EXPECT_EQ(point(2, 1.0, 0.2).result, 0);
}

TEST_F(MotionPort, StopStopsWhereTheRobotIs) {
  point(0, 0, 0.1);
  point(1, 0.5, 0.2);
  now_ns_ += 250 * kMs;
  const double here = first_joint();
  EXPECT_EQ(command(200122).result, 2) << "trajectory mode does not end while points are queued";
  EXPECT_EQ(command(200111).result, 0);
  now_ns_ += 1000 * kMs;
  EXPECT_EQ(first_joint(), here);
  EXPECT_EQ(command(200122).result, 0);
}

TEST_F(MotionPort, EndingTrajectoryModeMakesMotionImpossibleUntilItIsStartedAgain) {
  EXPECT_EQ(command(200101).result, 0);
  EXPECT_EQ(command(200122).result, 0);
  EXPECT_EQ(command(200101).result, 2);
  EXPECT_EQ(command(200101).subcode, 5008);
  EXPECT_EQ(point(0, 0, 0.1).result, 5);
  EXPECT_EQ(command(200121).result, 0);
  EXPECT_EQ(command(200101).result, 0);
}

TEST_F(MotionPort, DisconnectHangsUpWithoutAnAnswer) {
  const auto answer =
      commands_.obey({MotionRequest::kControl, 0, 5, 200130, 0, 0, {}, {}}, world_, settings_, now_ns_);
  EXPECT_TRUE(answer.hangs_up);
}

TEST_F(MotionPort, NothingMovesWhileTheControllerIsNotReady) {
  const auto subcode_with = [&](void (*change)(ControllerSettings&)) {
    settings_ = {};
    change(settings_);
    EXPECT_NE(command(200101).result, 0);
    EXPECT_NE(command(200121).result, 0);
    return point(0, 0, 0.1).subcode;
  };
  EXPECT_EQ(subcode_with([](auto& s) { s.e_stopped = 1; }), 5003);
  EXPECT_EQ(subcode_with([](auto& s) { s.in_error = 1; }), 5001);
  EXPECT_EQ(subcode_with([](auto& s) { s.automatic = 0; }), 5004);
  EXPECT_EQ(subcode_with([](auto& s) { s.drives_powered = 0; }), 5006);
}

TEST_F(MotionPort, ARobotWithAProgramOfItsOwnTakesNoCommandsUntilItIsHeld) {
  world_.motion.visit(std::array{Joints{0.3, 0.2}, Joints{0.1, 0.2}}, Profile::minimum_jerk, 0.5, 1, now_ns_);
  EXPECT_EQ(command(200101).subcode, 5009);
  world_.motion.set_rate(0, now_ns_);
  now_ns_ += 1000 * kMs;
  EXPECT_EQ(command(200101).result, 0);
  const double here = first_joint();
  EXPECT_EQ(point(0, 0, here).result, 0);
  EXPECT_EQ(point(1, 0.2, here + 0.01).result, 0);
  now_ns_ += 500 * kMs;
  world_.motion.visit(std::vector<Joints>{{0.5, 0.2}}, Profile::minimum_jerk, 0.5, 1, now_ns_);
  EXPECT_NEAR(first_joint(), here + 0.01, 1e-9) << "its own program begins where the commands left it";
  EXPECT_EQ(command(200101).subcode, 5009);
  now_ns_ += 20'000 * kMs;
  EXPECT_EQ(command(200101).result, 0) << "a program of one posture is over when that is reached";
}

TEST_F(MotionPort, StatusSaysWhatTheSettingsSay) {
  settings_.automatic = 0;
  settings_.e_stopped = 1;
  const auto sends = controller_cycle(world_, settings_, {}, now_ns_, 0);
  StatusRecord expected;
  expected.e_stopped = 1;
  expected.drives_powered = 0;
  expected.mode = 1;
  expected.motion_possible = 0;
  EXPECT_EQ(sends.back(), status_message(ByteOrder::big, expected));
}

}  // namespace
}  // namespace calibrd::sim
