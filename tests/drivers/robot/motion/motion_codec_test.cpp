// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_codec.hpp"

#include <gtest/gtest.h>

#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/simple_message/decode.hpp"
#include "drivers/robot/simple_message/encode.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {
namespace {

namespace sm = simple_message;
using Bytes = std::vector<std::byte>;

constexpr sm::WireFormat kBig{sm::ByteOrder::big, 4}, kLittle{sm::ByteOrder::little, 4};

template <class Body>
std::vector<sm::GoodVector> recorded() {
  std::vector<sm::GoodVector> found;
  for (const auto& vector : sm::good_vectors())
    if (std::holds_alternative<Body>(vector.message.body)) found.push_back(vector);
  return found;
}

Bytes reply(sm::MotionReply body, sm::CommType type = sm::CommType::service_reply) {
  const auto code = type == sm::CommType::service_reply ? sm::ReplyCode::success : sm::ReplyCode::none;
  return sm::encode({type, code, body}, kBig);
}

TEST(MotionCodec, ACommandIsByteForByteWhatTheReferenceLibrarySends) {
  const auto vectors = recorded<sm::MotionControl>();
  ASSERT_GE(vectors.size(), 2u);
  for (const auto& vector : vectors) {
    const auto& body = std::get<sm::MotionControl>(vector.message.body);
    ASSERT_EQ(body.command, static_cast<std::int32_t>(MotionCommand::check_motion_ready));
    const MotionCodec codec(vector.format, body.group);
    EXPECT_EQ(codec.control(MotionCommand::check_motion_ready, body.sequence), vector.bytes) << vector.name;
  }
}

TEST(MotionCodec, ReadsARecordedAnswerWholeAndByteByByte) {
  const auto vectors = recorded<sm::MotionReply>();
  ASSERT_GE(vectors.size(), 2u);
  for (const auto& vector : vectors) {
    const auto& body = std::get<sm::MotionReply>(vector.message.body);
    MotionCodec codec(vector.format, body.group);
    std::vector<MotionAnswer> answers = *codec.decode(vector.bytes);
    for (const std::byte byte : vector.bytes) {
      const auto more = codec.decode({&byte, 1});
      answers.insert(answers.end(), more->begin(), more->end());
    }
    ASSERT_EQ(answers.size(), 2u);
    for (const auto& answer : answers) {
      EXPECT_EQ(static_cast<std::int32_t>(answer.result), body.result);
      EXPECT_EQ(answer.command, body.command);
      EXPECT_EQ(answer.sequence, body.sequence);
      EXPECT_EQ(in_words(answer), "failure: not in REMOTE (5005)");
    }
  }
}

TEST(MotionCodec, APointIsOneMessageWithAllFieldsInTheConfiguredOrder) {
  for (const auto& format : {kBig, kLittle}) {
    const MotionCodec codec(format, 1);
    const Bytes bytes = codec.point(3, {0.5, {0.25, -0.5}, {0.125, 0}, {1, -1}});
    EXPECT_EQ(bytes.size(), 16u + 136u);
    const auto message = sm::decode(bytes, format);
    ASSERT_TRUE(message) << message.error().message();
    EXPECT_EQ(message->comm_type, sm::CommType::service_request);
    const auto& point = std::get<sm::JointTrajectoryPointFull>(message->body);
    EXPECT_EQ(point.robot_id, 1);
    EXPECT_EQ(point.sequence, 3);
    EXPECT_EQ(point.valid_fields, 15);
    EXPECT_EQ(point.time_s, 0.5);
    EXPECT_EQ(point.positions, (sm::JointValues{0.25, -0.5}));
    EXPECT_EQ(point.velocities, (sm::JointValues{0.125}));
    EXPECT_EQ(point.accelerations, (sm::JointValues{1, -1}));
  }
}

TEST(MotionCodec, TheReplyCodeOfTheHeaderDoesNotMatterTheResultDoes) {
  MotionCodec codec(kBig, 0);
  const auto answers = codec.decode(reply({0, 1, 200121, 4, 0, {}}));
  ASSERT_TRUE(answers);
  EXPECT_EQ(answers->at(0).result, MotionResult::alarm);
}

TEST(MotionCodec, AResultNobodyKnowsIsNoSuccess) {
  MotionCodec codec(kBig, 0);
  for (const std::int32_t result : {-1, 7, 1000})
    EXPECT_EQ(codec.decode(reply({0, 1, 200121, result, 0, {}}))->at(0).result, MotionResult::invalid);
}

TEST(MotionCodec, AnythingElseThanAnAnswerToThisGroupIsAnError) {
  const auto refused = [](const Bytes& bytes) {
    MotionCodec codec(kBig, 0);
    const auto answers = codec.decode(bytes);
    return !answers && answers.error().code == MotionError::reply_unreadable;
  };
  EXPECT_TRUE(refused(reply({1, 1, 200121, 0, 0, {}})));
  EXPECT_TRUE(refused(reply({0, 1, 200121, 0, 0, {}}, sm::CommType::topic)));
  EXPECT_TRUE(refused(sm::encode({sm::CommType::service_reply, sm::ReplyCode::failure, sm::Ping{}}, kBig)));
}

TEST(MotionCodec, TheOtherByteOrderIsNamed) {
  MotionCodec codec(kLittle, 0);
  const auto answers = codec.decode(reply({0, 1, 200121, 0, 0, {}}));
  ASSERT_FALSE(answers);
  EXPECT_NE(answers.error().message().find("peer sends big endian"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
