// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/shared_answers.hpp"

#include <gtest/gtest.h>

#include <future>

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

class SharedAnswersTest : public ::testing::Test {
 protected:
  Request question(std::chrono::milliseconds ago = 0ms, const std::string& path = "/cloud") {
    Request request{"GET", path, {}, {}, {}};
    request.came -= ago;
    return request;
  }
  Response ask(const Request& request, int status = 200) {
    return shared_.get(request, [&] { return Response{status, {}, "answer " + std::to_string(++made_)}; });
  }

  SharedAnswers shared_;
  int made_ = 0;
};

TEST_F(SharedAnswersTest, WhoAskedBeforeItWasBegunIsGivenWhatAnotherIsStillSent) {
  const auto first = ask(question()), second = ask(question(1s));
  EXPECT_EQ(first.text(), "answer 1");
  EXPECT_EQ(second.shared_body, first.shared_body);
}

TEST_F(SharedAnswersTest, WhoAsksLaterIsGivenANewOne) {
  const auto first = ask(question());
  EXPECT_EQ(ask(question()).text(), "answer 2");
}

TEST_F(SharedAnswersTest, WhatNobodyIsSentAnyMoreIsGone) {
  EXPECT_EQ(ask(question()).text(), "answer 1");
  EXPECT_EQ(ask(question(1s)).text(), "answer 2");
}

TEST_F(SharedAnswersTest, AnotherPathOrQueryIsAnotherAnswer) {
  const auto first = ask(question());
  auto other = question(1s);
  other.query["format"] = "pcd";
  EXPECT_EQ(ask(other).text(), "answer 2");
  EXPECT_EQ(ask(question(1s, "/other")).text(), "answer 3");
}

TEST_F(SharedAnswersTest, FailuresAreNobodyElses) {
  const auto first = ask(question(), 503);
  EXPECT_EQ(first.text(), "answer 1");
  EXPECT_EQ(ask(question(1s)).text(), "answer 2");
}

TEST_F(SharedAnswersTest, ManyWhoAskAtOnceAreMadeOne) {
  std::vector<std::future<Response>> asked;
  std::promise<void> all_have_asked;
  const auto wait = all_have_asked.get_future().share();
  const auto request = question();
  for (int i = 0; i < 8; ++i)
    asked.push_back(std::async(std::launch::async, [&] {
      return shared_.get(request, [&] {
        wait.wait();
        return Response{200, {}, "answer " + std::to_string(++made_)};
      });
    }));
  all_have_asked.set_value();
  std::vector<Response> answers;
  for (auto& one : asked) answers.push_back(one.get());
  EXPECT_EQ(made_, 1);
}

}  // namespace
}  // namespace calibrd::api
