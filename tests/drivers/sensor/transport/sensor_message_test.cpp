// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/sensor_message.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> result;
  for (const int value : values) result.push_back(static_cast<std::byte>(value));
  return result;
}

TEST(SensorMessage, HelloIsFiveBytesLittleEndian) {
  EXPECT_EQ(encode(SensorHello{0x01020304}), bytes({1, 4, 3, 2, 1}));
}

TEST(SensorMessage, FailureIsCodeAndText) {
  EXPECT_EQ(encode(SensorFailure{SensorError::no_device, "ab"}), bytes({3, 6, 0, 2, 0, 'a', 'b'}));
}

TEST(SensorMessage, StreamingComesBackAsItWas) {
  const SensorStreaming sent{.device = "Fake (fake://0)",
                             .notice = "no image",
                             .width = 512,
                             .height = 424,
                             .fps = 30,
                             .depth_unit_um = 1000};
  const auto decoded = decode(encode(sent));
  ASSERT_TRUE(decoded);
  const auto& received = std::get<SensorStreaming>(*decoded);
  EXPECT_EQ(received.device, sent.device);
  EXPECT_EQ(received.notice, sent.notice);
  EXPECT_EQ(received.width, 512);
  EXPECT_EQ(received.height, 424);
  EXPECT_EQ(received.fps, 30);
  EXPECT_EQ(received.depth_unit_um, 1000u);
}

TEST(SensorMessage, RefusesEveryTruncationAndExtension) {
  for (const SensorMessage& message :
       {SensorMessage(SensorHello{}), SensorMessage(SensorStreaming{"d", "n", 1, 2, 3, 4}),
        SensorMessage(SensorFailure{SensorError::hung, "why"})}) {
    auto whole = encode(message);
    for (std::size_t length = 0; length < whole.size(); ++length)
      EXPECT_FALSE(decode(std::span(whole).first(length))) << length;
    whole.push_back(std::byte{0});
    EXPECT_FALSE(decode(whole));
  }
}

TEST(SensorMessage, RefusesUnknownKindsAndErrors) {
  EXPECT_FALSE(decode(bytes({0, 0, 0, 0, 0})));
  EXPECT_FALSE(decode(bytes({9, 0, 0, 0, 0})));
  EXPECT_FALSE(decode(bytes({3, 0, 0, 0, 0})));
  EXPECT_FALSE(decode(bytes({3, 200, 0, 0, 0})));
}

TEST(SensorMessage, CutsTextsThatDoNotFit) {
  const std::string endless(100000, 'x');
  const auto encoded = encode(SensorStreaming{.device = endless, .notice = endless});
  EXPECT_LE(encoded.size(), kMaxSensorMessage);
  EXPECT_TRUE(decode(encoded));
}

TEST(SensorError, EveryOneSaysWhatToDo) {
  for (int value = 1; value <= kLastSensorError; ++value) {
    const std::string text = sensor_error_category().message(value);
    EXPECT_NE(text.find(';'), std::string::npos) << value << ": " << text;
    EXPECT_EQ(text.find("unknown"), std::string::npos) << value;
  }
}

}  // namespace
}  // namespace calibrd
