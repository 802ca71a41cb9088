// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/robot_word.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

PoseCheck looks_off(double sigmas) {
  PoseCheck check;
  check.enough_evidence = true;
  check.shift_sigmas = sigmas;
  check.agrees = sigmas < 4;
  return check;
}

std::vector<double> posture(int number) { return {0.2 * number, -0.1 * number}; }

TEST(RobotWord, OnePostureAloneSaysNothingAgainstThePose) {
  RobotWord word;
  for (int i = 0; i < 100; ++i) word.add(looks_off(12), posture(1), i);
  EXPECT_TRUE(word.has_doubt());
  EXPECT_FALSE(word.is_against());
}

TEST(RobotWord, PosturesOnEndDoAndGoodOnesTakeItBack) {
  RobotWord word;
  for (int i = 0; i < 3; ++i) word.add(looks_off(6), posture(i), i);
  EXPECT_TRUE(word.is_against());
  for (int i = 3; i < 6; ++i) word.add(looks_off(0.5), posture(i), i);
  EXPECT_TRUE(word.is_against_no_more());
}

TEST(RobotWord, WhatOneMotionShowsIsNoDoubtThatHolds) {
  RobotWord word;
  for (int i = 0; i < 9; ++i) word.add(looks_off(6), posture(i), 0.1 * i);
  EXPECT_TRUE(word.has_doubt());
  EXPECT_FALSE(word.is_against());
  for (int i = 9; i < 12; ++i) word.add(looks_off(6), posture(i), 0.1 * i);
  EXPECT_TRUE(word.is_against());
}

TEST(RobotWord, WhatAGoodModelLooksLikeIsNoDoubt) {
  RobotWord word;
  for (int i = 0; i < 1000; ++i) word.add(looks_off(2.2), posture(i), i);
  EXPECT_FALSE(word.has_doubt());
}

TEST(RobotWord, HoldsForAWhile) {
  RobotWord word;
  EXPECT_FALSE(word.agrees_within(1e6, 10));
  word.add(looks_off(1), posture(1), 10);
  EXPECT_TRUE(word.agrees_since(9, 11));
  EXPECT_FALSE(word.agrees_since(10.5, 11)) << "it is of before";
  EXPECT_FALSE(word.agrees_since(9, 13)) << "it is not of now";
  EXPECT_TRUE(word.agrees_within(5, 13));
  EXPECT_FALSE(word.is_off(10));
  word.add(looks_off(9), posture(1), 14);
  EXPECT_TRUE(word.is_off(14.2));
  EXPECT_FALSE(word.is_off(15));
  EXPECT_FALSE(word.agrees_within(1e6, 14));
}

TEST(RobotWord, AComparisonWithoutEvidenceIsNone) {
  RobotWord word;
  PoseCheck check = looks_off(9);
  check.enough_evidence = false;
  word.add(check, posture(1), 10);
  EXPECT_FALSE(word.newest());
  EXPECT_FALSE(word.has_doubt());
}

}  // namespace
}  // namespace calibrd
