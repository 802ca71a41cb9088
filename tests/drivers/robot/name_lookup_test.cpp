// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/name_lookup.hpp"

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <optional>

#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {
namespace {

struct Answer {
  std::error_code error;
  NameLookup::Endpoints endpoints;
};

Answer look_up(const std::string& host) {
  boost::asio::io_context context;
  const auto work = boost::asio::make_work_guard(context);
  NameLookup lookup(context.get_executor(), host, 50241);
  std::optional<Answer> answer;
  lookup.start([&](const std::error_code& error, const NameLookup::Endpoints& endpoints) {
    answer = {error, endpoints};
    context.stop();
  });
  context.run_for(std::chrono::seconds(10));
  return answer.value();
}

TEST(NameLookup, TakesAddressesAsTheyAre) {
  const Answer answer = look_up("192.168.255.1");
  ASSERT_EQ(answer.endpoints.size(), 1u);
  EXPECT_EQ(answer.endpoints[0].address().to_string(), "192.168.255.1");
  EXPECT_EQ(answer.endpoints[0].port(), 50241);
  EXPECT_EQ(look_up("::1").endpoints.at(0).address().to_string(), "::1");
}

TEST(NameLookup, FindsThisHost) {
  const Answer answer = look_up("localhost");
  ASSERT_FALSE(answer.error);
  EXPECT_TRUE(answer.endpoints.at(0).address().is_loopback());
  EXPECT_EQ(answer.endpoints.at(0).port(), 50241);
}

TEST(NameLookup, SaysWhenThereIsNoSuchHost) {
  const Answer answer =
      look_up(std::string(70, 'a'));  // longer than a label may be: needs no DNS to be wrong
  EXPECT_EQ(answer.error, RobotLinkError::host_unknown);
  EXPECT_TRUE(answer.endpoints.empty());
}

TEST(NameLookup, AnswersNobodyAfterCancel) {
  for (const char* host : {"localhost", "127.0.0.1"}) {
    bool answered = false;
    {
      boost::asio::io_context context;
      NameLookup lookup(context.get_executor(), host, 50241);
      lookup.start([&](const auto&, const auto&) { answered = true; });
      lookup.cancel();
      context.run();
    }
    EXPECT_FALSE(answered) << host;
  }
}

TEST(NameLookup, ASecondCallTakesThePlaceOfTheFirst) {
  boost::asio::io_context context;
  NameLookup lookup(context.get_executor(), "localhost", 50241);
  const auto work = boost::asio::make_work_guard(context);
  int first = 0;
  int second = 0;
  lookup.start([&](const auto&, const auto&) { ++first; });
  lookup.start([&](const auto&, const auto&) {
    ++second;
    context.stop();
  });
  context.run_for(std::chrono::seconds(10));
  EXPECT_EQ(first, 0);
  EXPECT_EQ(second, 1);
}

}  // namespace
}  // namespace calibrd
