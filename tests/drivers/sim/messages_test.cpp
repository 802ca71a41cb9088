// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/messages.hpp"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace calibrd::sim {
namespace {

namespace json = boost::json;

constexpr TenJoints kPositions{0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7};
constexpr TenJoints kVelocities{1, -1, 0.5, -0.5, 0.25, -0.25, 0.125};
constexpr TenJoints kAccelerations{0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};

std::string hex(const Bytes& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

/// Bytes that the reference library wrote for the message of that name.
std::string recorded(std::string_view name, ByteOrder order) {
  std::ifstream file(CALIBRD_ROBOT_VECTORS);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const json::value vectors = json::parse(text);
  for (const json::value& vector : vectors.at("good").as_array())
    if (vector.at("name").as_string() == name && vector.at("real_bytes").as_int64() == 4 &&
        vector.at("order").as_string() == (order == ByteOrder::big ? "big" : "little"))
      return std::string(vector.at("hex").as_string());
  throw std::runtime_error("no vector " + std::string(name));
}

class Messages : public testing::TestWithParam<ByteOrder> {};

TEST_P(Messages, JointPositionIsAsRecorded) {
  EXPECT_EQ(hex(joint_position_message(GetParam(), 1, kPositions)),
            recorded("JOINT_POSITION topic", GetParam()));
}

TEST_P(Messages, FeedbackOfMotoRosIsAsRecorded) {
  EXPECT_EQ(hex(joint_feedback_message(GetParam(), {0, 6, 0, kPositions, kVelocities, {}})),
            recorded("JOINT_FEEDBACK as MotoROS sends it (pos+vel, no time)", GetParam()));
}

TEST_P(Messages, FeedbackWithAllFieldsIsAsRecorded) {
  EXPECT_EQ(hex(joint_feedback_message(GetParam(), {1, 15, 12.5, kPositions, kVelocities, kAccelerations})),
            recorded("JOINT_FEEDBACK all fields, group 1", GetParam()));
}

TEST_P(Messages, FeedbackOfTwoGroupsIsAsRecorded) {
  const FeedbackRecord first{0, 6, 0, kPositions, kVelocities, {}};
  const FeedbackRecord second{1, 6, 0, kVelocities, kPositions, {}};
  EXPECT_EQ(hex(joint_feedback_ex_message(GetParam(), std::array{first, second})),
            recorded("MOTO_JOINT_FEEDBACK_EX two groups", GetParam()));
}

TEST_P(Messages, StatusIsAsRecorded) {
  EXPECT_EQ(hex(status_message(GetParam(), {1, 0, 0, 0, 1, 2, 1})), recorded("STATUS running", GetParam()));
  EXPECT_EQ(hex(status_message(GetParam(), {0, 1, 4107, 1, 0, 1, 0})),
            recorded("STATUS e-stop, alarm 4107, teach", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(BothOrders, Messages, testing::Values(ByteOrder::little, ByteOrder::big));

}  // namespace
}  // namespace calibrd::sim
