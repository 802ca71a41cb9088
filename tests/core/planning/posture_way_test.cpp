// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/posture_way.hpp"

#include <gtest/gtest.h>

#include "core/planning/posture_rules.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

const std::vector<double> kUpright{0, 0, 0, 0.2, 0, 0.2};
const std::vector<double> kTurned{0.8, 0, 0, 0.2, 0, 0.2};
const std::vector<double> kBowedToTheFloor{0, 1.5, 0, 1.3, 0, 0};
const std::vector<double> kFoldedIntoItself{0, 0, 0, 3.0, 0, 0};

std::string objection(std::vector<std::vector<double>> postures, const std::vector<double>& from = kUpright,
                      double table_m = 0) {
  WaySettings settings;
  settings.min_height_m = table_m;
  return way_objection(test_arm(), from, postures, settings).value_or("");
}

TEST(PostureWay, AWayAboveTheTableIsFine) { EXPECT_EQ(objection({kTurned, kUpright}), ""); }

TEST(PostureWay, NamesThePostureThatIsBelowTheTable) {
  EXPECT_NE(objection({kTurned, kBowedToTheFloor}).find("posture 2: "), std::string::npos);
  EXPECT_NE(objection({kTurned, kBowedToTheFloor}).find("below the table"), std::string::npos);
  EXPECT_EQ(objection({kTurned, kBowedToTheFloor}, kUpright, -2), "");
}

TEST(PostureWay, LooksAtWhatLiesBetweenToo) {
  std::mt19937_64 random(3);
  int pairs = 0;
  for (int round = 0; round < 3000 && pairs < 5; ++round) {
    const double table_m = 0.05 * (round % 8);  // the higher, the more ways dip below it
    const auto from = random_posture(test_arm(), 0.1, random), to = random_posture(test_arm(), 0.1, random);
    auto middle = from;
    for (std::size_t j = 0; j < from.size(); ++j) middle[j] = (from[j] + to[j]) / 2;
    const bool ends_are_fine =
        objection({from}, from, table_m).empty() && objection({to}, to, table_m).empty();
    if (!ends_are_fine || objection({middle}, middle, table_m).find("below the table") == std::string::npos)
      continue;
    ++pairs;
    EXPECT_NE(objection({to}, from, table_m).find("% of the way there"), std::string::npos);
  }
  EXPECT_EQ(pairs, 5);
}

TEST(PostureWay, ForbidsLinksThatMeet) {
  EXPECT_NE(objection({kFoldedIntoItself}).find("too near to each other"), std::string::npos);
}

TEST(PostureWay, KeepsToTheLimitsOfEveryJoint) {
  for (const Joint& joint : test_arm().joints()) {
    if (joint.position_index < 0 || !joint.limits) continue;
    auto beyond = kUpright;
    beyond[static_cast<std::size_t>(joint.position_index)] = joint.limits->upper + 0.01;
    const auto against = objection({beyond}, kUpright, -10);
    EXPECT_NE(against.find("posture 1: " + joint.name + " at "), std::string::npos) << against;
  }
}

TEST(PostureWay, APostureOfAnotherRobotIsRefused) {
  EXPECT_EQ(objection({{0.1, 0.2}}), "posture 1: it has 2 joints, the robot has 6");
  EXPECT_NE(objection({{0, 0, NAN, 0, 0, 0}}), "");
}

}  // namespace
}  // namespace calibrd
