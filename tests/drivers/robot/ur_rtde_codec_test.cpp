// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <random>

#include "drivers/robot/robot_link_error.hpp"
#include "tests/drivers/robot/ur_rtde_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using namespace rtde_bytes;
using rtde::RtdeError;

TEST_F(UrRtdeCodecTest, DeliversJointsAndStatus) {
  stream();
  const CodecOutput output = take(data(), 5ms);
  ASSERT_TRUE(output.joints && output.status);
  EXPECT_EQ(output.joints->positions_rad, (std::vector<double>{0.1, -0.2, 0.3, -0.4, 0.5, -0.6}));
  EXPECT_EQ(output.joints->velocities_rad, (std::vector<double>{1, -1, 0.5, -0.5, 0.25, -0.25}));
  EXPECT_EQ(output.joints->controller_time_s, 100);
  EXPECT_EQ(output.joints->stamp, start_ + 5ms);
  EXPECT_EQ(output.status->stamp, start_ + 5ms);
  EXPECT_EQ(output.status->drives_powered, true);
  EXPECT_EQ(output.status->e_stopped, false);
  EXPECT_EQ(output.status->in_error, false);
  EXPECT_EQ(output.status->motion_possible, true);
  EXPECT_EQ(output.status->in_motion, std::nullopt);
  EXPECT_EQ(output.status->mode, ControllerStatus::Mode::unknown);
}

TEST_F(UrRtdeCodecTest, StampsAPackageWithTheArrivalOfItsFirstByte) {
  stream();
  const Bytes bytes = data();
  (void)codec_->decode(std::span(bytes).first(1), start_);
  (void)codec_->decode(std::span(bytes).subspan(1, 50), start_ + 10ms);
  const CodecOutput output = codec_->decode(std::span(bytes).subspan(51), start_ + 20ms);
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->stamp, start_);
}

TEST_F(UrRtdeCodecTest, KeepsOnlyTheNewestJointsOfOnePiece) {
  stream();
  Data newer{.timestamp_s = 100.008};
  newer.positions[0] = 0.7;
  const CodecOutput output = take(data() + data(newer));
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->positions_rad[0], 0.7);
  EXPECT_EQ(output.joint_messages, 2U);
}

TEST_F(UrRtdeCodecTest, DamagedDataBreaksTheConnection) {
  const Bytes whole = fields({});
  const auto cut = [&](std::size_t size) {
    Bytes bytes = number(1, 1) + whole;
    bytes.resize(size);
    return package('U', bytes);
  };
  for (const Bytes& wrong : {data({}, 2), package('U'), cut(whole.size()), cut(whole.size() + 2), Bytes(3),
                             number(0xffff, 2) + Bytes(20)}) {
    begin({});
    stream();
    EXPECT_TRUE(broken_by(wrong)) << wrong.size();
  }
}

TEST_F(UrRtdeCodecTest, DropsWhatIsNoNumberOrNoJoint) {
  stream();
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double wrong : {nan, inf, -inf}) {
    EXPECT_EQ(problem_of({.timestamp_s = wrong == -inf ? inf : wrong}), RtdeError::value_not_finite);
    EXPECT_EQ(problem_of({.positions = {0, 0, wrong}}), RtdeError::value_not_finite);
    EXPECT_EQ(problem_of({.velocities = {wrong}}), RtdeError::value_not_finite);
  }
  EXPECT_EQ(problem_of({.positions = {0, 0, 0, 0, 0, 1e30}}), RtdeError::value_out_of_range);
  EXPECT_EQ(problem_of({.velocities = {0, -101}}), RtdeError::value_out_of_range);
  const CodecOutput output = take(data({.positions = {0, 0, nan}}));
  EXPECT_EQ(output.rejected_values, 1U);
  EXPECT_EQ(output.joints_problem->detail, "position of joint 3");
  EXPECT_TRUE(take(data({.timestamp_s = 101})).joints) << "what follows is read";
}

TEST_F(UrRtdeCodecTest, DropsPositionsOutsideTheRangeOfTheirJoint) {
  begin({.joint_ranges = {{-1, 1}, {-0.1, 0.1}}});
  stream();
  EXPECT_EQ(problem_of({}), RobotLinkError::outside_joint_range);
}

TEST_F(UrRtdeCodecTest, DeliversAsManyJointsAsConfigured) {
  begin({.joint_count = 5, .joint_ranges = {}});
  stream();
  const CodecOutput output = take(data());
  EXPECT_EQ(output.joints->positions_rad.size(), 5U);
  EXPECT_EQ(output.joints->velocities_rad.size(), 5U);
}

TEST_F(UrRtdeCodecTest, AControllerThatRepeatsItselfIsNotFresh) {
  stream();
  EXPECT_TRUE(take(data()).joints);
  EXPECT_EQ(problem_of({}), RtdeError::clock_stands_still);
  EXPECT_TRUE(take(data({.timestamp_s = 100.008})).joints);
}

TEST_F(UrRtdeCodecTest, AClockThatRunsBackEndsTheConnection) {
  stream();
  EXPECT_TRUE(take(data()).joints);
  EXPECT_EQ(broken_by(data({.timestamp_s = 0.1})), RtdeError::clock_ran_back);
  EXPECT_EQ(codec_->begin(), hex("0005560002"));
  stream();
  EXPECT_TRUE(take(data({.timestamp_s = 0.2})).joints) << "the new connection begins with a new clock";
}

TEST_F(UrRtdeCodecTest, JointsOfAnArmWithoutPowerAreNotUsed) {
  stream();
  for (const std::int32_t mode : {-1, 0, 1, 2, 3, 4, 8, 99}) {
    EXPECT_EQ(problem_of({.timestamp_s = 200.0 + mode, .mode = mode}), RtdeError::arm_without_power) << mode;
    begin({});
    stream();
  }
  double clock_s = 300;
  for (const std::int32_t mode : {5, 6, 7}) {
    const CodecOutput output = take(data({.timestamp_s = ++clock_s, .mode = mode}));
    EXPECT_TRUE(output.joints) << mode;
    EXPECT_EQ(output.status->drives_powered, true);
  }
  EXPECT_EQ(take(data({.timestamp_s = 400, .mode = 3})).status->drives_powered, false);
  EXPECT_EQ(take(data({.timestamp_s = 401, .mode = 2})).status->drives_powered, std::nullopt);
}

TEST_F(UrRtdeCodecTest, SafetyBitsBecomeTheStatus) {
  stream();
  double clock_s = 100;
  const auto status = [&](std::uint32_t bits, std::int32_t mode = 7) {
    return *take(data({.timestamp_s = ++clock_s, .mode = mode, .safety = bits})).status;
  };
  for (const int bit : {5, 6, 7}) {
    EXPECT_EQ(status(1U << bit).e_stopped, true) << bit;
    EXPECT_EQ(status(1U << bit).motion_possible, false) << bit;
  }
  for (const int bit : {2, 8, 9}) EXPECT_EQ(status(1U << bit).in_error, true) << bit;
  EXPECT_EQ(status(0x2).motion_possible, true) << "reduced mode";
  EXPECT_EQ(status(0x1, 5).motion_possible, false) << "brakes are on";
  EXPECT_EQ(status(0x10).motion_possible, false) << "safeguard stop";
}

TEST_F(UrRtdeCodecTest, SurvivesRandomlyDamagedStreams) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> byte(0, 255);
  const Bytes whole = handshake() + data() + data({.timestamp_s = 100.008});
  std::uniform_int_distribution<std::size_t> place(0, whole.size() - 1);
  int taken = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes damaged = whole;
    for (int i = 0; i <= round % 4; ++i) damaged[place(random)] = static_cast<std::byte>(byte(random));
    begin({});
    const CodecOutput output = take(damaged);
    if (!output.joints) continue;
    ++taken;
    for (const double position : output.joints->positions_rad) ASSERT_LE(std::abs(position), 100);
  }
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace calibrd
