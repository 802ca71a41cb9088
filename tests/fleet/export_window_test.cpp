// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/export_window.hpp"

#include <gtest/gtest.h>

namespace calibrd::fleet {
namespace {

using namespace std::chrono_literals;

constexpr ExportWindow::Time kStart{};

TEST(ExportWindow, SendsOnceAndAgainEverMoreSeldom) {
  ExportWindow window(4);
  window.add(1, "a", "A");
  EXPECT_EQ(window.take_due(kStart), std::vector<std::string>{"A"});
  EXPECT_TRUE(window.take_due(kStart + 14s).empty());
  EXPECT_EQ(window.take_due(kStart + 15s).size(), 1u);
  EXPECT_TRUE(window.take_due(kStart + 44s).empty());
  EXPECT_EQ(window.take_due(kStart + 45s).size(), 1u);
  auto now = kStart + 45s;
  for (int i = 0; i < 10; ++i) {
    now += 300s;
    EXPECT_EQ(window.take_due(now).size(), 1u) << "five minutes at most";
  }
}

TEST(ExportWindow, WhatIsDroppedIsNotSentAgainAndMakesRoom) {
  ExportWindow window(2);
  window.add(4, "a", "A");
  window.add(9, "b", "B");
  EXPECT_EQ(window.room(), 0u);
  EXPECT_TRUE(window.drop("a"));
  EXPECT_FALSE(window.drop("a"));
  EXPECT_EQ(window.room(), 1u);
  EXPECT_EQ(window.newest(), 9);
  EXPECT_EQ(window.take_due(kStart), std::vector<std::string>{"B"});
}

TEST(ExportWindow, ANewBrokerOrCollectorIsSentAllAtOnce) {
  ExportWindow window(4);
  window.add(1, "a", "A");
  window.add(2, "b", "B");
  window.take_due(kStart);
  window.send_all_again();
  EXPECT_EQ(window.take_due(kStart + 1s), (std::vector<std::string>{"A", "B"}));
}

TEST(ExportWindow, AnotherDatabaseIsReadFromItsBeginning) {
  ExportWindow window(4);
  window.follow(1);
  window.add(40, "a", "A");
  window.follow(1);
  EXPECT_EQ(window.newest(), 40);
  window.follow(2);
  EXPECT_EQ(window.newest(), 0);
  window.add(1, "b", "B");
  EXPECT_EQ(window.newest(), 1);
  EXPECT_EQ(window.take_due(kStart), (std::vector<std::string>{"A", "B"}))
      << "what waited goes on being sent";
}

TEST(ExportWindow, BeginningAnewTheOutboxIsReadFromItsBeginning) {
  ExportWindow window(4);
  window.add(1, "refused", "R");
  window.add(2, "b", "B");
  window.take_due(kStart);
  window.drop("refused");
  window.begin_anew();
  EXPECT_EQ(window.newest(), 0);
  window.add(1, "refused", "R");
  EXPECT_EQ(window.take_due(kStart), (std::vector<std::string>{"B", "R"}));
}

TEST(ExportWindow, ARowThatIsReadTwiceIsHeldOnce) {
  ExportWindow window(4);
  window.add(1, "a", "A");
  window.take_due(kStart);
  window.add(1, "a", "A");
  EXPECT_EQ(window.size(), 1u);
  EXPECT_TRUE(window.take_due(kStart + 1s).empty());
}

}  // namespace
}  // namespace calibrd::fleet
