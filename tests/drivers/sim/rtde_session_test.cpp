// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/rtde_session.hpp"

#include <gtest/gtest.h>

namespace calibrd::sim {
namespace {

Bytes bytes_of(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

std::string hex_of(const Bytes& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

// Requests and replies of the maker's client library and its controller.
const std::string kAskForTwo = "0005560002", kAskForOne = "0005560001", kAskVersion = "000376",
                  kStart = "000353", kPause = "000350", kAccepted = "00045601", kRefused = "00045600",
                  kStarted = "00045301",
                  kAskOutputs = "001d4f405f40000000000074696d657374616d702c61637475616c5f71",
                  kOutputs = "00134f01444f55424c452c564543544f523644";

class Session : public testing::Test {
 protected:
  std::string say(const std::string& request) {
    const auto reply = session_.take(bytes_of(request), settings_);
    return reply ? hex_of(*reply) : "thrown out";
  }
  ControllerSettings settings_;
  RtdeSession session_;
};

TEST_F(Session, AnswersAsAControllerDoes) {
  EXPECT_EQ(say(kAskForTwo), kAccepted);
  EXPECT_EQ(say(kAskVersion), "00137600000005000000020000000000000001");
  EXPECT_EQ(say(kAskOutputs), kOutputs);
  EXPECT_EQ(session_.frequency_hz(), 125);
  EXPECT_TRUE(session_.data({}, settings_).empty()) << "not before the start";
  EXPECT_EQ(say(kStart), kStarted);
  RtdeState state;
  state.timestamp_s = 0.75;
  state.positions_rad = {0.1, -0.2, 0.3, -0.4, 0.5, -0.6};
  EXPECT_EQ(hex_of(session_.data(state, settings_)),
            "003c55013fe80000000000003fb999999999999abfc999999999999a3fd3333333333333bfd999999999999a3fe00000"
            "00000000bf"
            "e3333333333333");
  EXPECT_EQ(say(kPause), "00045001");
  EXPECT_TRUE(session_.data(state, settings_).empty());
}

TEST_F(Session, TakesRequestsInSingleBytesAndSeveralAtOnce) {
  std::string replies;
  const std::string all = kAskForTwo + kAskOutputs + kStart;
  for (std::size_t i = 0; i < all.size(); i += 2) replies += say(all.substr(i, 2));
  EXPECT_EQ(replies, kAccepted + kOutputs + kStarted);
  EXPECT_EQ(say(kAskForTwo + kPause), kAccepted + "00045001");
}

TEST_F(Session, RefusesProtocolTwoWhenTold) {
  settings_.rtde_protocol = 1;
  EXPECT_EQ(say(kAskForTwo), kRefused);
  EXPECT_EQ(say(kAskForOne), kAccepted);
  EXPECT_EQ(say("00174f74696d657374616d702c726f626f745f6d6f6465"), "000f4f444f55424c452c494e543332");
  EXPECT_EQ(say(kStart), kStarted);
  EXPECT_EQ(hex_of(session_.data({}, settings_)), "000f55000000000000000000000007")
      << "no recipe in protocol 1";
}

TEST_F(Session, AMissingVariableIsNotFoundAndNothingStarts) {
  settings_.rtde_missing = "actual_q";
  (void)say(kAskForTwo);
  EXPECT_EQ(say(kAskOutputs), "00144f00444f55424c452c4e4f545f464f554e44");
  EXPECT_EQ(say(kStart), "00045300");
}

TEST_F(Session, TextsComeBeforeTheAnswersAndBetweenTheData) {
  settings_.rtde_texts = 1;
  const std::string reply = say(kAskForTwo);
  EXPECT_EQ(reply.substr(4, 2), "4d");
  EXPECT_TRUE(reply.ends_with(kAccepted));
  (void)say(kAskOutputs + kStart);
  EXPECT_EQ(hex_of(session_.data({}, settings_)).substr(4, 2), "4d");
  EXPECT_EQ(hex_of(session_.data({}, settings_)).substr(4, 2), "55");
}

TEST_F(Session, ThrowsOutWhoWantsToSetInputsOrSendsRubbish) {
  EXPECT_EQ(say("00044900"), "thrown out");
  EXPECT_EQ(RtdeSession().take(bytes_of("000056"), settings_), std::nullopt);
  EXPECT_EQ(RtdeSession().take(bytes_of("000456000000"), settings_), std::nullopt);
}

}  // namespace
}  // namespace calibrd::sim
