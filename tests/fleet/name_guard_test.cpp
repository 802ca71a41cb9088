// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/name_guard.hpp"

#include <gtest/gtest.h>

namespace calibrd::fleet {
namespace {

using namespace std::chrono_literals;

constexpr NameGuard::Time kBegin{1h};
constexpr const char *kOwn = R"({"instance":"us"})", *kOther = R"({"instance":"them","online":false})";

TEST(NameGuard, SpeaksOnceWhoeverWasThereBeforeWouldBeBack) {
  NameGuard guard("us");
  guard.connected(kBegin);
  EXPECT_EQ(guard.voice(kBegin + 5s), Voice::waiting);
  EXPECT_EQ(guard.voice(kBegin + 6s), Voice::clear);
}

TEST(NameGuard, WhatAnEarlierRunHasLeftIsNoOtherDaemon) {
  NameGuard guard("us");
  guard.connected(kBegin);
  EXPECT_FALSE(guard.hear(kOther, kBegin));
  EXPECT_EQ(guard.voice(kBegin + 6s), Voice::clear);
}

TEST(NameGuard, WhoSpokeWhileWeWereAwayIsAnotherOne) {
  NameGuard guard("us");
  guard.connected(kBegin);
  EXPECT_FALSE(guard.hear(kOwn, kBegin));
  guard.connected(kBegin + 10s);
  EXPECT_EQ(guard.voice(kBegin + 10s), Voice::waiting);
  EXPECT_TRUE(guard.hear(kOther, kBegin + 10s));
  EXPECT_FALSE(guard.hear(kOther, kBegin + 11s)) << "said once";
  EXPECT_EQ(guard.voice(kBegin + 10s), Voice::contested);
  EXPECT_EQ(guard.voice(kBegin + 69s), Voice::contested);
  guard.connected(kBegin + 69s);
  EXPECT_EQ(guard.voice(kBegin + 128s), Voice::contested) << "thrown out again";
  EXPECT_EQ(guard.voice(kBegin + 129s), Voice::clear);
}

TEST(NameGuard, ABrokerThatComesBackIsNoOtherDaemon) {
  NameGuard guard("us");
  guard.connected(kBegin);
  guard.connected(kBegin + 100s);
  for (const auto* status : {kOwn, "", "{", "[]", R"({"instance":1})", R"({"format":"status/1"})"})
    EXPECT_FALSE(guard.hear(status, kBegin + 100s)) << status;
  EXPECT_EQ(guard.voice(kBegin + 101s), Voice::clear);
}

TEST(NameGuard, NoTwoRunsAreAlike) {
  EXPECT_EQ(random_instance().size(), 32u);
  EXPECT_NE(random_instance(), random_instance());
}

}  // namespace
}  // namespace calibrd::fleet
