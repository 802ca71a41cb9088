// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/decode.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/robot/simple_message/encode.hpp"
#include "drivers/robot/simple_message/error.hpp"
#include "drivers/robot/simple_message/framer.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd::simple_message {
namespace {

constexpr WireFormat kBig{ByteOrder::big, 4};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::byte> frame_of(Body body) {
  return encode({CommType::topic, ReplyCode::none, std::move(body)}, kBig);
}

JointFeedback feedback_with(std::int32_t valid_fields) {
  JointFeedback feedback;
  feedback.valid_fields = valid_fields;
  return feedback;
}

std::error_code error_of(const Body& body) {
  const auto decoded = decode(frame_of(body), kBig);
  return decoded ? std::error_code{} : decoded.error().code;
}

TEST(Decode, ReadsBackEveryGoodVector) {
  const auto vectors = good_vectors();
  EXPECT_EQ(vectors.size(), 45u);
  for (const GoodVector& vector : vectors) {
    const auto decoded = decode(vector.bytes, vector.format);
    ASSERT_TRUE(decoded) << vector.name << ": " << decoded.error().message();
    EXPECT_EQ(decoded->body.index(), vector.message.body.index()) << vector.name;
    EXPECT_EQ(encode(*decoded, vector.format), vector.bytes) << vector.name;
  }
}

TEST(Decode, ReadsTheValuesOfAStatusInWireOrder) {
  const auto decoded = decode(frame_of(RobotStatus{1, 0, 4107, 1, -1, 2, 0}), kBig);
  ASSERT_TRUE(decoded);
  const auto& status = std::get<RobotStatus>(decoded->body);
  EXPECT_EQ(status.drives_powered, 1);
  EXPECT_EQ(status.e_stopped, 0);
  EXPECT_EQ(status.error_code, 4107);
  EXPECT_EQ(status.in_error, 1);
  EXPECT_EQ(status.in_motion, -1);
  EXPECT_EQ(status.mode, 2);
  EXPECT_EQ(status.motion_possible, 0);
}

TEST(Decode, ReadsATrajectoryPoint) {
  JointTrajectoryPointFull point{3, 17, kValidTime | kValidPositions, 1.5, {0.25, -0.5}, {}, {}};
  const auto decoded = decode(frame_of(point), kBig);
  ASSERT_TRUE(decoded);
  const auto& read = std::get<JointTrajectoryPointFull>(decoded->body);
  EXPECT_EQ(read.robot_id, 3);
  EXPECT_EQ(read.sequence, 17);
  EXPECT_EQ(read.time_s, 1.5);
  EXPECT_EQ(read.positions[1], -0.5);
}

TEST(Decode, ClearsReservedBitsOfValidFields) {
  const auto decoded = decode(frame_of(feedback_with(0x0159e10f)), kBig);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<JointFeedback>(decoded->body).valid_fields, 15);

  JointFeedbackEx both;
  both.group_count = 1;
  both.records[0].valid_fields = 0x70000002;
  const auto decoded_both = decode(frame_of(both), kBig);
  ASSERT_TRUE(decoded_both);
  EXPECT_EQ(std::get<JointFeedbackEx>(decoded_both->body).records[0].valid_fields, 2);
}

TEST(Decode, RejectsEveryValidRealThatIsNotFinite) {
  for (const double bad :
       {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    for (std::size_t joint = 0; joint < kJointCount; ++joint) {
      JointFeedback feedback = feedback_with(kValidMask);
      feedback.positions[joint] = bad;
      EXPECT_EQ(error_of(feedback), SimpleMessageError::value_not_finite);
      feedback = feedback_with(kValidMask);
      feedback.velocities[joint] = bad;
      EXPECT_EQ(error_of(feedback), SimpleMessageError::value_not_finite);
      feedback = feedback_with(kValidMask);
      feedback.accelerations[joint] = bad;
      EXPECT_EQ(error_of(feedback), SimpleMessageError::value_not_finite);
    }
    JointFeedback feedback = feedback_with(kValidMask);
    feedback.time_s = bad;
    EXPECT_EQ(error_of(feedback), SimpleMessageError::value_not_finite);
  }
}

TEST(Decode, IgnoresTheRubbishInFieldsNotMarkedAsValid) {
  JointFeedback feedback = feedback_with(kValidPositions);
  feedback.velocities.fill(kNan);
  feedback.accelerations.fill(1e30);
  feedback.time_s = kNan;
  EXPECT_FALSE(error_of(feedback));
}

TEST(Decode, RejectsPositionsWhereNoJointCanBe) {
  JointPosition position;
  position.positions[2] = -100.5;
  const auto decoded = decode(frame_of(position), kBig);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, SimpleMessageError::value_out_of_range);
  EXPECT_NE(decoded.error().message().find("position of joint 3 is -100.5"), std::string::npos)
      << decoded.error().message();
  EXPECT_TRUE(decode(frame_of(position), kBig, {200, 100}));
}

TEST(Decode, RejectsSpeedsNoJointCanHave) {
  JointFeedback feedback = feedback_with(kValidVelocities);
  feedback.velocities[0] = 1e30;
  EXPECT_EQ(error_of(feedback), SimpleMessageError::value_out_of_range);
}

TEST(Decode, ChecksOnlyTheGroupsThatACountCovers) {
  JointFeedbackEx both;
  both.group_count = 2;
  both.records[2] = feedback_with(kValidPositions);
  both.records[2].positions.fill(kNan);
  EXPECT_FALSE(error_of(both));
  both.group_count = 3;
  EXPECT_EQ(error_of(both), SimpleMessageError::value_not_finite);
}

TEST(Decode, DiagnosesTheOtherWidthOfReals) {
  const Message message{CommType::topic, ReplyCode::none, feedback_with(kValidPositions)};
  const auto wide = decode(encode(message, {ByteOrder::big, 8}), {ByteOrder::big, 4});
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().code, SimpleMessageError::peer_sends_float64);
  const auto narrow = decode(encode(message, {ByteOrder::big, 4}), {ByteOrder::big, 8});
  ASSERT_FALSE(narrow);
  EXPECT_EQ(narrow.error().code, SimpleMessageError::peer_sends_float32);
}

TEST(Decode, RejectsAFrameThatItsLengthDoesNotDescribe) {
  auto frame = frame_of(Ping{});
  frame.push_back(std::byte{0});
  const auto decoded = decode(frame, kBig);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, SimpleMessageError::length_out_of_range);
  EXPECT_FALSE(decode({}, kBig));
}

TEST(Decode, RejectsHeadersThatNoMessageHas) {
  struct Case {
    std::int32_t type, comm_type, reply_code;
  };
  for (const Case& header : {Case{0, 1, 0}, Case{1, 0, 0}, Case{1, 4, 0}, Case{1, -1, 0}, Case{1, 1, 1},
                             Case{1, 2, 2}, Case{1, 3, 0}, Case{1, 3, 3}, Case{1, 3, -1}}) {
    ByteWriter frame(kBig);
    for (const std::int32_t field : {12, header.type, header.comm_type, header.reply_code})
      frame.write_int(field);
    const auto decoded = decode(frame.bytes(), kBig);
    ASSERT_FALSE(decoded) << header.type << ' ' << header.comm_type << ' ' << header.reply_code;
    EXPECT_EQ(decoded.error().code, SimpleMessageError::invalid_header);
  }
}

TEST(Decode, KeepsTheBodyOfTypesItDoesNotKnow) {
  const OtherMessage other{77, {std::byte{1}, std::byte{2}, std::byte{3}}};
  const auto decoded = decode(frame_of(other), kBig);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<OtherMessage>(decoded->body).type, 77);
  EXPECT_EQ(std::get<OtherMessage>(decoded->body).body, other.body);
}

TEST(SimpleMessageError, SaysWhatToDoForEveryCode) {
  for (int code = 1; code <= static_cast<int>(SimpleMessageError::value_out_of_range); ++code) {
    const std::string message = make_error_code(static_cast<SimpleMessageError>(code)).message();
    EXPECT_EQ(message.find("unknown"), std::string::npos) << code;
    EXPECT_GT(message.size(), 20u) << code;
  }
}

TEST(SimpleMessageError, TellsDamagedStreamsFromDamagedValues) {
  EXPECT_TRUE(breaks_stream(SimpleMessageError::wrong_body_size));
  EXPECT_TRUE(breaks_stream(SimpleMessageError::group_count_out_of_range));
  EXPECT_FALSE(breaks_stream(SimpleMessageError::value_not_finite));
  EXPECT_FALSE(breaks_stream({}));
}

}  // namespace
}  // namespace calibrd::simple_message
