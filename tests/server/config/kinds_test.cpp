// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/kinds.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

TEST(Durations, AreReadWithTheirUnit) {
  EXPECT_EQ(*parse_duration("250ms"), 250ms);
  EXPECT_EQ(*parse_duration("1.5s"), 1500ms);
  EXPECT_EQ(*parse_duration("10min"), 10min);
  EXPECT_EQ(*parse_duration("2h"), 2h);
}

TEST(Durations, WithoutUnitOrNegativeAreRefused) {
  for (const auto* text : {"", "60", "s", "-1s", "1d", "nan s", "1e300h"})
    EXPECT_FALSE(parse_duration(text)) << text;
}

TEST(Durations, AreWrittenInTheLargestWholeUnit) {
  EXPECT_EQ(write_duration(250ms), "250ms");
  EXPECT_EQ(write_duration(60s), "1min");
  EXPECT_EQ(write_duration(90s), "90s");
  EXPECT_EQ(write_duration(0s), "0s");
}

TEST(Kinds, NumbersThatAreNotFiniteAreRefused) {
  EXPECT_FALSE(real(-1, 1).read(parse_text_value("nan")));
  EXPECT_FALSE(positive_real().read(parse_text_value("inf")));
  EXPECT_FALSE(optional_pose().read(parse_text_value("[nan, 0, 0, 0, 0, 0, 1]")));
}

TEST(Kinds, TextGivenOnTheCommandLineNeedsNoQuotes) {
  EXPECT_EQ(*text().read(parse_text_value("base_link")), "base_link");
  EXPECT_EQ(*text().read(parse_text_value("5")), "5");
  EXPECT_EQ(*text().read(parse_text_value("\"quoted\"")), "quoted");
}

}  // namespace
}  // namespace calibrd
