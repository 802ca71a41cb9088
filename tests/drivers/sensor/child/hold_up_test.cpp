// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/hold_up.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

HoldUp::Clock::time_point at(std::chrono::milliseconds ms) { return HoldUp::Clock::time_point(1h) + ms; }

TEST(HoldUp, NothingIsWrongWithAProcessThatRuns) {
  HoldUp hold_up;
  for (auto t = 0ms; t < 10s; t += 100ms) {
    hold_up.look(at(t));
    EXPECT_TRUE(hold_up.is_over(at(t)));
  }
}

TEST(HoldUp, WhatComesRightAfterAStopIsNotUsed) {
  HoldUp hold_up;
  hold_up.look(at(0ms));
  hold_up.look(at(10s));
  for (auto t = 0ms; t < 500ms; t += 33ms) {
    hold_up.look(at(10s + t));
    EXPECT_FALSE(hold_up.is_over(at(10s + t)));
  }
  EXPECT_TRUE(hold_up.is_over(at(10500ms)));
}

}  // namespace
}  // namespace calibrd
