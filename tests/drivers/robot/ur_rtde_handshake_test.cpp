// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/drivers/robot/ur_rtde_fixture.hpp"

namespace calibrd {
namespace {

using namespace rtde_bytes;
using rtde::RtdeError;

const Bytes kOutputsRequest =
    package('O', real(125) + text("timestamp,actual_q,actual_qd,robot_mode,safety_status_bits"));

TEST_F(UrRtdeCodecTest, AsksOneThingAfterTheOther) {
  EXPECT_EQ(take(accepted('V')).reply, hex("000376"));
  EXPECT_EQ(take(controller_version()).reply, kOutputsRequest);
  EXPECT_EQ(take(outputs(1)).reply, hex("000353"));
  const CodecOutput started = take(accepted('S'));
  EXPECT_TRUE(started.reply.empty());
  EXPECT_EQ(started.messages, 1U);
  EXPECT_TRUE(take(data()).joints);
}

TEST_F(UrRtdeCodecTest, ReadsHandshakeAndDataSplitAtEveryByte) {
  const Bytes stream = text_message("booted") + handshake(7) + data({}, 7);
  for (std::size_t split = 0; split <= stream.size(); ++split) {
    begin({});
    const CodecOutput first = codec_->decode(std::span(stream).first(split), start_);
    const CodecOutput second = codec_->decode(std::span(stream).subspan(split), start_);
    ASSERT_FALSE(first.broken || second.broken) << split;
    ASSERT_EQ(first.reply + second.reply, hex("000376") + kOutputsRequest + hex("000353")) << split;
    ASSERT_EQ(first.joint_messages + second.joint_messages, 1U) << split;
    ASSERT_EQ(first.messages + second.messages, 5U) << split;
  }
}

TEST_F(UrRtdeCodecTest, ReadsHandshakeAndDataInSingleBytes) {
  const Bytes stream = handshake() + data();
  CodecOutput last;
  for (std::size_t i = 0; i < stream.size(); ++i)
    last = codec_->decode(std::span(stream).subspan(i, 1), start_);
  EXPECT_TRUE(last.joints);
}

TEST_F(UrRtdeCodecTest, FallsBackToProtocolOne) {
  EXPECT_EQ(take(accepted('V', false)).reply, hex("0005560001"));
  EXPECT_EQ(take(accepted('V')).reply, hex("000376"));
  EXPECT_EQ(take(controller_version(3)).reply,
            package('O', text("timestamp,actual_q,actual_qd,robot_mode,safety_status_bits")));
  EXPECT_EQ(take(outputs_of_protocol_1()).reply, hex("000353"));
  const CodecOutput output = take(accepted('S') + package('U', fields({})));
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->positions_rad[5], -0.6);
}

TEST_F(UrRtdeCodecTest, GivesUpWhenBothProtocolsAreRefused) {
  (void)take(accepted('V', false));
  EXPECT_EQ(broken_by(accepted('V', false)), RtdeError::protocol_refused);
}

TEST_F(UrRtdeCodecTest, NamesTheVariableThatIsNotFoundAndTheSoftwareThatLacksIt) {
  (void)take(accepted('V') + controller_version(3) + text_message("no such output"));
  const CodecOutput output = take(outputs(0, "DOUBLE,VECTOR6D,VECTOR6D,INT32,NOT_FOUND"));
  ASSERT_TRUE(output.broken);
  EXPECT_EQ(output.broken->code, RtdeError::variable_not_found);
  EXPECT_EQ(output.broken->detail,
            "safety_status_bits, controller software 3.11.1, the controller says \"no such output\"");
  EXPECT_TRUE(output.reply.empty());
}

TEST_F(UrRtdeCodecTest, ReportsARefusedStart) {
  (void)take(accepted('V') + controller_version() + outputs(1));
  EXPECT_EQ(broken_by(accepted('S', false)), RtdeError::start_refused);
}

TEST_F(UrRtdeCodecTest, TextsMayComeAtAnyTimeAndProveNothing) {
  const Bytes texts =
      text_message("hello") + package('M') + package('M', number(200, 1)) + package('P', number(1, 1));
  for (const Bytes& reply : {accepted('V'), controller_version(), outputs(1), accepted('S'), data()}) {
    const CodecOutput said = take(texts);
    EXPECT_EQ(said.skipped, 4U);
    EXPECT_EQ(said.messages, 0U);
    EXPECT_FALSE(said.broken);
    EXPECT_TRUE(said.reply.empty());
    EXPECT_EQ(take(reply).messages, 1U);
  }
}

TEST_F(UrRtdeCodecTest, DataBeforeTheStartIsSkipped) {
  const CodecOutput output = take(data());
  EXPECT_FALSE(output.broken);
  EXPECT_FALSE(output.joints);
  EXPECT_EQ(output.messages, 0U);
}

TEST_F(UrRtdeCodecTest, RepliesOutOfTurnBreakTheConnection) {
  for (const Bytes& wrong : {controller_version(), outputs(1), accepted('S'), package('I', number(1, 1)),
                             package('x'), package('V'), package('V', Bytes(2))}) {
    begin({});
    EXPECT_TRUE(broken_by(wrong)) << std::to_integer<int>(wrong[2]);
  }
  begin({});
  stream();
  EXPECT_EQ(broken_by(accepted('V')), RtdeError::unexpected_package);
}

TEST_F(UrRtdeCodecTest, AnotherServiceOnThePortIsNamed) {
  // What the realtime port 30003 sends: a length of 4 bytes; and little-endian simple_message.
  for (const Bytes& first : {number(1220, 4) + Bytes(100), hex("900000000f00000001000000")}) {
    begin({});
    const CodecOutput output = take(first);
    ASSERT_TRUE(output.broken);
    EXPECT_NE(output.broken->message().find("30004"), std::string::npos) << output.broken->message();
  }
}

TEST_F(UrRtdeCodecTest, TheWholeHandshakeIsMadeAgainOnTheNextConnection) {
  (void)take(accepted('V', false) + accepted('V') + controller_version(3) + outputs_of_protocol_1() +
             accepted('S'));
  EXPECT_EQ(codec_->begin(), hex("0005560002"));
  EXPECT_FALSE(take(package('U', fields({}))).joints) << "data of the last connection";
  stream();
  EXPECT_TRUE(take(data()).joints);
}

TEST_F(UrRtdeCodecTest, ForgetsHalfAPackageWithItsConnection) {
  (void)take(hex("0004"));
  (void)codec_->begin();
  EXPECT_EQ(take(accepted('V')).reply, hex("000376"));
}

TEST_F(UrRtdeCodecTest, SaysThatTheHandshakeIsUnderWay) {
  const CodecOutput output = take(accepted('V'));
  ASSERT_TRUE(output.joints_problem);
  EXPECT_EQ(output.joints_problem->code, RtdeError::handshake_unfinished);
}

}  // namespace
}  // namespace calibrd
