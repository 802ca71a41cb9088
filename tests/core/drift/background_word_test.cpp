// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_word.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

constexpr double kBetweenFrames_s = 1.0 / 30;

TEST(BackgroundWord, OfALuckyFrameNowAndThenIsNone) {
  BackgroundWord word;
  double now_s = 0;
  for (int frame = 0; frame < 300; ++frame, now_s += kBetweenFrames_s) word.add(frame % 3 == 0, false, now_s);
  EXPECT_FALSE(word.pins_within(1, now_s));
}

TEST(BackgroundWord, OfMostFramesHoldsUntilItIsOld) {
  BackgroundWord word;
  double now_s = 0;
  for (int frame = 0; frame < 30; ++frame, now_s += kBetweenFrames_s) word.add(frame % 5 != 0, true, now_s);
  EXPECT_TRUE(word.pins_within(1, now_s));
  EXPECT_TRUE(word.pins_finely_within(1, now_s));
  EXPECT_FALSE(word.pins_within(1, now_s + 2));
}

TEST(BackgroundWord, IsToBeGivenAgainAfterAGap) {
  BackgroundWord word;
  double now_s = 0;
  for (int frame = 0; frame < 30; ++frame, now_s += kBetweenFrames_s) word.add(true, true, now_s);
  word.on_gap();
  now_s += 5;
  word.add(true, true, now_s);
  EXPECT_FALSE(word.pins_within(1, now_s));
}

}  // namespace
}  // namespace calibrd
