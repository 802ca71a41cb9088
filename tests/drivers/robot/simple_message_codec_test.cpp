// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message_codec.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "drivers/robot/robot_link_error.hpp"
#include "drivers/robot/simple_message/encode.hpp"
#include "drivers/robot/simple_message/error.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using namespace simple_message;
using Bytes = std::vector<std::byte>;

constexpr WireFormat kBig{ByteOrder::big, 4};
const Clock::time_point kStart{1000s};

Bytes topic(Body body, WireFormat format = kBig) {
  return encode({CommType::topic, ReplyCode::none, body}, format);
}

JointFeedback feedback(double first_joint, std::int32_t group = 0) {
  return {group, kValidPositions | kValidVelocities, 0, {first_joint, 0.2}, {0.5}, {}};
}

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

SimpleMessageCodec codec_for(WireFormat format = kBig, int group = 0) {
  SimpleMessageSettings settings;
  settings.format = format;
  settings.group = group;
  SimpleMessageCodec codec(settings);
  EXPECT_TRUE(codec.begin().empty()) << "the state port is never written to";
  return codec;
}

CodecOutput decode_all(const Bytes& bytes, WireFormat format = kBig, int group = 0) {
  return codec_for(format, group).decode(bytes, kStart);
}

/// Adds up what several pieces gave.
void add(CodecOutput& sum, CodecOutput part) {
  if (part.joints) sum.joints = part.joints;
  if (part.status) sum.status = part.status;
  if (part.joints_problem) sum.joints_problem = part.joints_problem;
  if (part.broken) sum.broken = part.broken;
  sum.joint_messages += part.joint_messages;
  sum.messages += part.messages;
  sum.rejected_values += part.rejected_values;
  sum.other_group += part.other_group;
  sum.skipped += part.skipped;
}

enum class Fate { breaks, drops_value, skips, no_position, taken, other_group };

const std::map<std::string, Fate> kFates = {
    {"length 0", Fate::breaks},
    {"length -1", Fate::breaks},
    {"length 11 (< header)", Fate::breaks},
    {"length 2000, complete body follows", Fate::breaks},
    {"length 0x7fffffff", Fate::breaks},
    {"JOINT_FEEDBACK body 8 bytes short (length 136)", Fate::breaks},
    {"JOINT_FEEDBACK body 8 bytes long (length 152)", Fate::breaks},
    {"STATUS with comm_type 0", Fate::breaks},
    {"STATUS topic with reply code 1", Fate::breaks},
    {"message type 0", Fate::breaks},
    {"unknown type 77 topic", Fate::skips},
    {"positions NaN", Fate::drops_value},
    {"positions +inf in joint 3", Fate::drops_value},
    {"positions 1e30", Fate::drops_value},
    {"valid_fields without POSITION", Fate::no_position},
    {"valid_fields with undefined high bits 0x0159e10f", Fate::taken},
    {"robot_id 7 on a one-group configuration", Fate::other_group},
    {"robot_id -1", Fate::other_group},
    {"FEEDBACK_EX group count 5", Fate::breaks},
    {"FEEDBACK_EX group count -1", Fate::breaks},
};

void expect_fate(const std::string& name, const CodecOutput& output) {
  const Fate fate = kFates.at(name);
  EXPECT_EQ(output.broken.has_value(), fate == Fate::breaks) << name;
  EXPECT_EQ(output.joints.has_value(), fate == Fate::taken) << name;
  EXPECT_EQ(output.rejected_values, fate == Fate::drops_value ? 1u : 0u) << name;
  EXPECT_EQ(output.skipped, fate == Fate::skips ? 1u : 0u) << name;
  EXPECT_EQ(output.other_group, fate == Fate::other_group ? 1u : 0u) << name;
  // What follows on the connection is read unless the stream is broken.
  EXPECT_EQ(output.status.has_value(), fate != Fate::breaks) << name;
}

TEST(SimpleMessageCodec, TreatsEveryBadVectorAsStatedSplitAtEveryByte) {
  const auto vectors = bad_vectors();
  EXPECT_EQ(vectors.size(), kFates.size());
  for (const BadVector& vector : vectors) {
    for (const ByteOrder order : {ByteOrder::little, ByteOrder::big}) {
      const WireFormat format{order, 4};
      const Bytes stream =
          (order == ByteOrder::little ? vector.little : vector.big) + topic(RobotStatus{}, format);
      for (std::size_t split = 0; split <= stream.size(); ++split) {
        SimpleMessageCodec codec = codec_for(format);
        CodecOutput output = codec.decode(std::span(stream).first(split), kStart);
        if (!output.broken) add(output, codec.decode(std::span(stream).subspan(split), kStart));
        expect_fate(vector.name, output);
        if (HasFailure()) return;
      }
    }
  }
}

CodecOutput decode_in_pieces(std::span<const std::byte> stream, const WireFormat& format,
                             std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> piece(1, 60);
  SimpleMessageCodec codec = codec_for(format);
  CodecOutput output;
  while (!stream.empty() && !output.broken) {
    const std::size_t size = std::min(stream.size(), piece(random));
    add(output, codec.decode(stream.first(size), kStart));
    stream = stream.subspan(size);
  }
  return output;
}

TEST(SimpleMessageCodec, TreatsEveryBadVectorAsStatedInRandomPieces) {
  std::mt19937 random(7);
  for (const BadVector& vector : bad_vectors()) {
    for (int round = 0; round < 40; ++round) {
      const WireFormat format{round % 2 == 0 ? ByteOrder::little : ByteOrder::big, 4};
      const Bytes& bytes = format.byte_order == ByteOrder::little ? vector.little : vector.big;
      expect_fate(vector.name, decode_in_pieces(bytes + topic(RobotStatus{}, format), format, random));
    }
  }
}

TEST(SimpleMessageCodec, ServesThePositionsUnderRubbishInValidFields) {
  for (const BadVector& vector : bad_vectors()) {
    if (kFates.at(vector.name) != Fate::taken) continue;
    const CodecOutput output = decode_all(vector.big);
    ASSERT_TRUE(output.joints);
    EXPECT_EQ(output.joints->positions_rad, std::vector<double>(10, 0.5));
  }
}

TEST(SimpleMessageCodec, ReadsTheFirstCycleOfAReferenceServer) {
  for (const std::string name : {"plain/feedback", "plain/position", "bswap/feedback", "bswap/position"}) {
    const WireFormat format{name.starts_with("bswap") ? ByteOrder::big : ByteOrder::little, 4};
    const CodecOutput output = decode_all(live_first_cycle(name), format);
    ASSERT_TRUE(output.joints && output.status) << name;
    EXPECT_EQ(output.messages, 2u) << name;
    EXPECT_FLOAT_EQ(static_cast<float>(output.joints->positions_rad[6]), 0.7F) << name;
    EXPECT_EQ(output.joints->velocities_rad.empty(), name.ends_with("position")) << name;
    EXPECT_EQ(output.status->drives_powered, true) << name;
    EXPECT_EQ(output.status->mode, ControllerStatus::Mode::automatic) << name;
  }
}

TEST(SimpleMessageCodec, LeavesWhatTheControllerDoesNotKnowUnset) {
  const CodecOutput output = decode_all(topic(RobotStatus{}));
  ASSERT_TRUE(output.status);
  EXPECT_EQ(output.status->e_stopped, std::nullopt);
  EXPECT_EQ(output.status->mode, ControllerStatus::Mode::unknown);
  const CodecOutput odd = decode_all(topic(RobotStatus{7, 7, 0, 7, 7, 7, 7}));
  EXPECT_EQ(odd.status->drives_powered, std::nullopt);
  EXPECT_EQ(odd.status->mode, ControllerStatus::Mode::unknown);
}

TEST(SimpleMessageCodec, KeepsOnlyTheNewestJointsOfOnePieceAndCountsTheOthers) {
  const CodecOutput output = decode_all(topic(feedback(0.1)) + topic(feedback(0.2)) + topic(feedback(0.3)));
  ASSERT_TRUE(output.joints);
  EXPECT_FLOAT_EQ(static_cast<float>(output.joints->positions_rad[0]), 0.3F);
  EXPECT_EQ(output.joint_messages, 3u);
}

TEST(SimpleMessageCodec, StampsAMessageWithTheArrivalOfItsFirstByte) {
  SimpleMessageCodec codec = codec_for();
  const Bytes message = topic(feedback(0.1));
  EXPECT_FALSE(codec.decode(std::span(message).first(1), kStart).joints);
  EXPECT_FALSE(codec.decode(std::span(message).subspan(1, 100), kStart + 10ms).joints);
  const CodecOutput output = codec.decode(std::span(message).subspan(101), kStart + 20ms);
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->stamp, kStart);
  EXPECT_EQ(codec.decode(message, kStart + 30ms).joints->stamp, kStart + 30ms);
}

TEST(SimpleMessageCodec, DeliversAsManyJointsAsConfigured) {
  SimpleMessageSettings settings;
  settings.joint_count = 7;
  SimpleMessageCodec codec(settings);
  const CodecOutput output = codec.decode(topic(feedback(0.1)), kStart);
  EXPECT_EQ(output.joints->positions_rad.size(), 7u);
  EXPECT_EQ(output.joints->velocities_rad.size(), 7u);
}

TEST(SimpleMessageCodec, TakesTheConfiguredGroupOnly) {
  const Bytes cycle = topic(feedback(0.1, 0)) + topic(feedback(0.2, 1)) + topic(feedback(0.3, 2));
  const CodecOutput output = decode_all(cycle, kBig, 1);
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->group, 1);
  EXPECT_FLOAT_EQ(static_cast<float>(output.joints->positions_rad[0]), 0.2F);
  EXPECT_EQ(output.joint_messages, 1u);
  EXPECT_EQ(output.other_group, 2u);
}

TEST(SimpleMessageCodec, NamesTheGroupThatTheControllerSends) {
  const CodecOutput output = decode_all(topic(feedback(0.1, 2)));
  ASSERT_TRUE(output.joints_problem);
  EXPECT_EQ(output.joints_problem->code, RobotLinkError::only_other_groups);
  EXPECT_NE(output.joints_problem->message().find("sends group 2, group 0 is configured"), std::string::npos);
}

TEST(SimpleMessageCodec, FindsNoFaultInOtherGroupsBesideItsOwn) {
  const CodecOutput output = decode_all(topic(feedback(0.1, 0)) + topic(feedback(0.2, 1)));
  EXPECT_FALSE(output.joints_problem);
}

TEST(SimpleMessageCodec, ServesJointsThatComeTwiceInACycleOnce) {
  JointFeedbackEx both;
  both.group_count = 2;
  both.records[0] = feedback(0.1);
  both.records[1] = feedback(0.2, 1);
  const CodecOutput output = decode_all(topic(feedback(0.1)) + topic(feedback(0.2, 1)) + topic(both));
  EXPECT_EQ(output.joint_messages, 1u);
  const CodecOutput only_ex = decode_all(topic(both), kBig, 1);
  ASSERT_TRUE(only_ex.joints);
  EXPECT_FLOAT_EQ(static_cast<float>(only_ex.joints->positions_rad[0]), 0.2F);
}

TEST(SimpleMessageCodec, DoesNotTakeUnusedRecordsForGroupZero) {
  JointFeedbackEx one;
  one.group_count = 1;
  one.records[0] = feedback(0.2, 1);
  EXPECT_FALSE(decode_all(topic(one)).joints) << "records beyond the count are all zero";
}

TEST(SimpleMessageCodec, DropsPositionsOutsideTheRangeOfTheirJoint) {
  SimpleMessageSettings settings;
  settings.joint_ranges = {{-1, 1}, {-0.1, 0.1}};
  SimpleMessageCodec codec(settings);
  const CodecOutput output = codec.decode(topic(feedback(0.1)), kStart);
  EXPECT_FALSE(output.joints);
  EXPECT_EQ(output.rejected_values, 1u);
  ASSERT_TRUE(output.joints_problem);
  EXPECT_EQ(output.joints_problem->detail, "joint 2 at 0.200000, allowed -0.100000 to 0.100000");
}

TEST(SimpleMessageCodec, TakesTopicsOnly) {
  const Bytes request = encode({CommType::service_request, ReplyCode::none, JointPosition{}}, kBig);
  const Bytes reply = encode({CommType::service_reply, ReplyCode::success, MotionReply{}}, kBig);
  const CodecOutput output = decode_all(request + reply);
  EXPECT_FALSE(output.joints);
  EXPECT_EQ(output.skipped, 2u);
  EXPECT_EQ(output.messages, 2u);
}

TEST(SimpleMessageCodec, DeliversWhatCameBeforeTheDamage) {
  const CodecOutput output = decode_all(topic(feedback(0.1)) + Bytes(8));
  EXPECT_TRUE(output.joints);
  ASSERT_TRUE(output.broken);
  EXPECT_EQ(output.broken->code, SimpleMessageError::length_out_of_range);
}

TEST(SimpleMessageCodec, ForgetsHalfAMessageWithItsConnection) {
  SimpleMessageCodec codec = codec_for();
  const Bytes message = topic(feedback(0.1));
  (void)codec.decode(std::span(message).first(50), kStart);
  (void)codec.begin();
  const CodecOutput output = codec.decode(message, kStart + 1s);
  EXPECT_FALSE(output.broken);
  ASSERT_TRUE(output.joints);
  EXPECT_EQ(output.joints->stamp, kStart + 1s);
}

TEST(SimpleMessageCodec, SurvivesRandomBytesAndRandomlyDamagedMessages) {
  std::mt19937 random(99);
  std::uniform_int_distribution<int> byte(0, 255);
  const Bytes cycle = live_first_cycle("bswap/feedback");
  for (int round = 0; round < 20000; ++round) {
    Bytes damaged = cycle;
    const int hits = 1 + round % 4;
    for (int i = 0; i < hits; ++i) {
      damaged[std::uniform_int_distribution<std::size_t>(0, cycle.size() - 1)(random)] =
          static_cast<std::byte>(byte(random));
    }
    const CodecOutput output = decode_all(damaged);
    if (!output.joints) continue;
    for (const double position : output.joints->positions_rad) ASSERT_LE(std::abs(position), 100);
  }
}

}  // namespace
}  // namespace calibrd
