// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/state_publisher.hpp"

#include <gtest/gtest.h>

#include "tests/api/fake_cell.hpp"

namespace calibrd::fleet {
namespace {

using namespace std::chrono_literals;

struct Retained {
  std::string payload;
  std::optional<std::chrono::seconds> expiry;
};

struct StatePublisherTest : testing::Test {
  StatePublisherTest() {
    cell.make_calibrated();
    cell.pose_report.max_unverified = api::Seconds(24 * 3600);
  }
  void look(std::chrono::seconds after) {
    publisher.look(keep(), voice, StatePublisher::Time{} + 1h + after);
  }
  PublishRetained keep() {
    return [this](const auto& topic, const auto& payload, auto expiry) {
      retained[topic] = {payload, expiry};
      order.push_back(topic);
      return true;
    };
  }
  bool holds(const std::string& topic, const std::string& text) {
    return retained[topic].payload.find(text) != std::string::npos;
  }

  api::FakeCell cell;
  const CellTopics topics{"calibrd", "cell7"};
  Voice voice = Voice::clear;
  StatePublisher publisher{cell, topics, {"cell7", "1.0", "a"}};
  std::map<std::string, Retained> retained;
  std::vector<std::string> order;
  const std::string pose = topics.pose("kinect2"), state = topics.state("kinect2"), status = topics.status();
};

TEST_F(StatePublisherTest, WhatHoldsOnlyWhileTheDaemonLivesExpiresInAMinute) {
  look(0s);
  for (const auto& topic : {pose, state, status}) EXPECT_EQ(retained[topic].expiry, 60s) << topic;
}

TEST_F(StatePublisherTest, AValidPoseExpiresWithItsValidity) {
  cell.pose_report.max_unverified = api::Seconds(5);
  look(0s);
  EXPECT_EQ(retained[pose].expiry, 5s);
}

TEST_F(StatePublisherTest, AllOfItIsToldAgainLongBeforeItExpires) {
  look(0s);
  order.clear();
  look(9s);
  EXPECT_TRUE(order.empty()) << "not more often than it has to be";
  look(10s);
  EXPECT_EQ(order, (std::vector<std::string>{status, pose, state}));
}

TEST_F(StatePublisherTest, APoseThatTurnsNotValidLosesItsTransformAndStays) {
  look(0s);
  EXPECT_TRUE(holds(pose, "T_base_sensor"));
  cell.set_valid(false);
  look(1s);
  EXPECT_FALSE(holds(pose, "T_base_sensor"));
  EXPECT_FALSE(holds(pose, "valid_until"));
  EXPECT_TRUE(holds(pose, "\"valid\": false"));
  EXPECT_FALSE(retained[pose].expiry);
}

TEST_F(StatePublisherTest, UnderANameThatMayBeAnothersNoPoseIsTold) {
  voice = Voice::waiting;
  look(0s);
  EXPECT_EQ(order, std::vector{status});
}

TEST_F(StatePublisherTest, UnderANameThatIsContestedNoPoseIsValid) {
  look(0s);
  ASSERT_TRUE(holds(pose, "T_base_sensor"));
  voice = Voice::contested;
  look(1s);
  EXPECT_TRUE(holds(pose, "\"valid\": false"));
  EXPECT_FALSE(holds(pose, "T_base_sensor"));
  EXPECT_TRUE(holds(pose, "mqtt.cell"));
  EXPECT_TRUE(holds(state, "\"pose_valid\": false"));
}

TEST_F(StatePublisherTest, WhoHearsNoMoreTrustsAPoseForAMinuteAtMost) {
  cell.pose_report.passed_check_age = api::Seconds(0);
  EXPECT_EQ(rest_of_validity(cell.pose_report), api::Seconds(60));
  cell.pose_report.max_unverified = api::Seconds(5);
  EXPECT_EQ(rest_of_validity(cell.pose_report), api::Seconds(5));
}

TEST_F(StatePublisherTest, AnEndTakesBackPoseAndStateBeforeTheFarewell) {
  look(0s);
  order.clear();
  publisher.end(keep());
  EXPECT_EQ(order, (std::vector<std::string>{pose, state, status}));
  EXPECT_FALSE(holds(pose, "T_base_sensor"));
  EXPECT_TRUE(holds(pose, "\"state\": \"unverified\""));
  EXPECT_TRUE(holds(state, "\"pose_valid\": false"));
  EXPECT_TRUE(holds(state, "\"health\": \"lost\""));
  EXPECT_TRUE(holds(status, "\"online\": false"));
  for (const auto& topic : order) EXPECT_FALSE(retained[topic].expiry) << topic;
}

}  // namespace
}  // namespace calibrd::fleet
