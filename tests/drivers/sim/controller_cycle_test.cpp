// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "drivers/sim/controller/cycle.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

using Settings = ControllerSettings;

class ControllerCycle : public testing::Test {
 protected:
  ControllerCycle() : world_(test::world_from("").state) {
    world_.motion.place({0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, 0);
    settings_.protocol = Settings::Protocol::joint_position;
  }
  std::vector<Bytes> cycle(std::uint64_t number = 0) const {
    return controller_cycle(world_, settings_, {}, monotonic_ns(), number);
  }
  RtdeState rtde(std::int64_t at_ns, std::int64_t started_ns, const Frozen& frozen = {}) const {
    return rtde_state(world_, settings_, frozen, at_ns, started_ns);
  }
  WorldState world_;
  Settings settings_;
};

TEST_F(ControllerCycle, StatusMayComeLessOftenThanJoints) {
  settings_.status_every = 11;
  for (std::uint64_t i = 0; i < 23; ++i) EXPECT_EQ(cycle(i).size(), i % 11 == 0 ? 2U : 1U) << i;
}

TEST_F(ControllerCycle, MessagesMayLeaveFieldByField) {
  const std::vector<Bytes> whole = cycle();
  settings_.send_bytes = 4;
  Bytes joined, expected;
  for (const Bytes& piece : cycle()) {
    EXPECT_EQ(piece.size(), 4U);
    joined.insert(joined.end(), piece.begin(), piece.end());
  }
  for (const Bytes& message : whole) expected.insert(expected.end(), message.begin(), message.end());
  EXPECT_EQ(joined, expected);
}

TEST_F(ControllerCycle, JointThreeIsStatedAgainstTheHorizontalWhenTold) {
  EXPECT_DOUBLE_EQ(reported_joints(world_, settings_, monotonic_ns())[2], 0.3);
  settings_.j3_from_horizontal = 1;
  EXPECT_NEAR(reported_joints(world_, settings_, monotonic_ns())[2], 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(reported_joints(world_, settings_, monotonic_ns())[1], 0.2);
}

TEST_F(ControllerCycle, AnEmergencyStopIsInTheStatus) {
  settings_.e_stopped = 1;
  StatusRecord stopped;
  stopped.e_stopped = 1;
  stopped.drives_powered = stopped.motion_possible = 0;
  EXPECT_EQ(cycle().back(), status_message(ByteOrder::big, stopped));
  EXPECT_TRUE(rtde(0, 0).emergency_stop);
  EXPECT_FALSE(rtde(0, 0).arm_has_power);
}

TEST_F(ControllerCycle, RtdeHasAClockOfItsOwnThatStandsStillWhenFrozen) {
  settings_.latency_s = 0.5;
  EXPECT_DOUBLE_EQ(rtde(5'000'000'000, 3'000'000'000).timestamp_s, 1.5);
  EXPECT_EQ(rtde(5'000'000'000, 0).positions_rad, (std::array{0.1, 0.2, 0.3, 0.4, 0.5, 0.6}));
  settings_.mode = Settings::Mode::frozen;
  const Frozen frozen{{0.9}, 4'000'000'000};
  EXPECT_DOUBLE_EQ(rtde(5'000'000'000, 3'000'000'000, frozen).timestamp_s, 0.5);
  EXPECT_EQ(rtde(5'000'000'000, 0, frozen).positions_rad[0], 0.9);
}

TEST_F(ControllerCycle, WithoutPositionsTheArmHasNoPower) {
  settings_.mode = Settings::Mode::status_only;
  EXPECT_FALSE(rtde(0, 0).arm_has_power);
}

}  // namespace
}  // namespace calibrd::sim
