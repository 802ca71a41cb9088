// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/events/event_hub.hpp"

#include <gtest/gtest.h>

namespace calibrd::api {
namespace {

std::string told(const EventBatch& batch) {
  std::string all;
  for (const Event& event : batch.events) all += event.type + event.data + " ";
  return all;
}

class Hub : public ::testing::Test {
 protected:
  EventHub hub_{"20261122T000000-abc"};
};

TEST_F(Hub, WhoIsNewIsToldTheWholeState) {
  hub_.publish("pose/a", "pose", "1");
  hub_.publish("pose/b", "pose", "2");
  hub_.publish("pose/a", "pose", "3");
  const auto batch = hub_.after({});
  EXPECT_TRUE(batch.is_whole_state);
  EXPECT_EQ(told(batch), "pose2 pose3 ");
  EXPECT_EQ(batch.last, 3U);
}

TEST_F(Hub, WhoWasAwayIsToldWhatWasMissed) {
  hub_.publish("pose/a", "pose", "1");
  hub_.publish("pose/a", "pose", "2");
  hub_.publish("pose/a", "pose", "3");
  const auto batch = hub_.after(1);
  EXPECT_FALSE(batch.is_whole_state);
  EXPECT_EQ(told(batch), "pose2 pose3 ");
  EXPECT_TRUE(hub_.after(3).events.empty());
}

TEST_F(Hub, WhatIsAsItWasIsNoEvent) {
  hub_.publish("pose/a", "pose", "1");
  hub_.publish("pose/a", "pose", "1");
  EXPECT_EQ(hub_.after({}).last, 1U);
}

TEST_F(Hub, WhoWasAwayForTooLongIsToldTheWholeState) {
  hub_.publish("robot", "robot", "r");
  for (std::size_t i = 0; i <= EventHub::kKept; ++i) hub_.publish("pose/a", "pose", std::to_string(i));
  const auto batch = hub_.after(1);
  EXPECT_TRUE(batch.is_whole_state);
  EXPECT_EQ(told(batch), "robotr pose" + std::to_string(EventHub::kKept) + " ");
  EXPECT_FALSE(hub_.after(2).is_whole_state);
}

TEST_F(Hub, AnIdOfAnotherRunOrOfTheFutureMeansNothing) {
  hub_.publish("pose/a", "pose", "1");
  EXPECT_EQ(hub_.number_of(hub_.id_of(1)), 1U);
  for (const char* id :
       {"", "1", "20261122T000000-abc", "20261122T000000-abc-", "20261122T000000-abc-x",
        "20261122T000000-abc-1x", "20261122T000000-abd-1", "20261122T000000-abc-99999999999999999999999"})
    EXPECT_FALSE(hub_.number_of(id)) << id;
  EXPECT_TRUE(hub_.after(2).is_whole_state);
}

}  // namespace
}  // namespace calibrd::api
