// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/messages/acknowledgement.hpp"

#include <gtest/gtest.h>

namespace calibrd::fleet {
namespace {

TEST(Acknowledgement, IsReadBackAsItWasWritten) {
  Acknowledgement written{{"a", "b"}, {{"c", "no \"id\""}}};
  const auto read = parse_acknowledgement(acknowledgement_json(written));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stored, written.stored);
  ASSERT_EQ(read->refused.size(), 1u);
  EXPECT_EQ(read->refused[0].calibration_id, "c");
  EXPECT_EQ(read->refused[0].reason, "no \"id\"");
}

TEST(Acknowledgement, WhatIsNoneAcknowledgesNothing) {
  for (const char* text : {"", "[]", "{", "7", "\"a\""}) EXPECT_FALSE(parse_acknowledgement(text)) << text;
  const auto odd = parse_acknowledgement(R"({"stored": [1, null, ["a"]], "refused": [{"reason": "x"}, 3]})");
  ASSERT_TRUE(odd);
  EXPECT_TRUE(odd->stored.empty());
  EXPECT_TRUE(odd->refused.empty());
}

}  // namespace
}  // namespace calibrd::fleet
