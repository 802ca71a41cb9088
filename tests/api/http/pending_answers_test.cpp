// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/pending_answers.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace calibrd::api {
namespace {

class PendingAnswersTest : public ::testing::Test {
 protected:
  void wait(std::optional<PendingAnswers::Answer>& answer, const void* body, std::size_t bytes,
            const std::string& name) {
    answer.emplace(pending_, body, bytes, [this, name] { given_up_ += name; });
  }

  Gauge bytes_;
  PendingAnswers pending_{100, bytes_};
  char first_ = 0, second_ = 0, third_ = 0;  // bodies
  std::optional<PendingAnswers::Answer> a_, b_, c_;
  std::string given_up_;
};

TEST_F(PendingAnswersTest, AreCountedWhileTheyWait) {
  wait(a_, &first_, 60, "a");
  wait(b_, &second_, 40, "b");
  EXPECT_EQ(bytes_.value(), 100);
  a_.reset();
  EXPECT_EQ(bytes_.value(), 40);
  b_.reset();
  EXPECT_EQ(bytes_.value(), 0);
  EXPECT_EQ(given_up_, "");
}

TEST_F(PendingAnswersTest, WhoHasTakenNothingForLongestIsGivenUp) {
  wait(a_, &first_, 40, "a");
  wait(b_, &second_, 40, "b");
  a_->note_progress();
  wait(c_, &third_, 40, "c");
  EXPECT_EQ(given_up_, "b");
  EXPECT_EQ(bytes_.value(), 80);
  b_.reset();  // as it does once its connection has failed
  EXPECT_EQ(bytes_.value(), 80);
}

TEST_F(PendingAnswersTest, ASharedBodyCountsOnce) {
  wait(a_, &first_, 60, "a");
  wait(b_, &first_, 60, "b");
  EXPECT_EQ(bytes_.value(), 60);
  a_.reset();
  EXPECT_EQ(bytes_.value(), 60);
  b_.reset();
  EXPECT_EQ(bytes_.value(), 0);
}

TEST_F(PendingAnswersTest, AllWhoShareABodyAreGivenUpForItsRoom) {
  wait(a_, &first_, 60, "a");
  wait(b_, &first_, 60, "b");
  wait(c_, &second_, 60, "c");
  EXPECT_EQ(given_up_, "ab");
  EXPECT_EQ(bytes_.value(), 60);
}

TEST_F(PendingAnswersTest, OneLargerThanTheLimitCanBeHad) {
  wait(a_, &first_, 60, "a");
  wait(b_, &second_, 1000, "b");
  EXPECT_EQ(given_up_, "a");
  EXPECT_EQ(bytes_.value(), 1000);
}

TEST_F(PendingAnswersTest, ProgressOfOneThatWasGivenUpIsHarmless) {
  wait(a_, &first_, 60, "a");
  wait(b_, &second_, 60, "b");
  a_->note_progress();
  EXPECT_EQ(bytes_.value(), 60);
  EXPECT_EQ(given_up_, "a");
}

}  // namespace
}  // namespace calibrd::api
