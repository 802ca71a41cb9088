// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/mqtt/back_off.hpp"

#include <gtest/gtest.h>

namespace calibrd::fleet {
namespace {

using namespace std::chrono_literals;

TEST(BackOff, WaitsLongerUpToFiveSeconds) {
  BackOff back_off;
  for (const auto pause : {500ms, 1000ms, 2000ms, 4000ms, 5000ms, 5000ms})
    EXPECT_EQ(back_off.next(0ms, 1), pause);
  EXPECT_EQ(back_off.next(0ms, 0), 3750ms) << "not all at one time";
}

TEST(BackOff, OnlyAConnectionThatLastedIsAReasonToHurry) {
  BackOff back_off;
  for (int i = 0; i < 5; ++i) back_off.next(0ms, 1);
  EXPECT_EQ(back_off.next(300ms, 1), 5000ms) << "thrown out at once, as by another client of this name";
  EXPECT_EQ(back_off.next(10s, 1), 500ms);
}

}  // namespace
}  // namespace calibrd::fleet
