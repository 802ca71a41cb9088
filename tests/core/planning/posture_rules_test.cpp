// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/posture_rules.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

const std::vector<double> kUpright{0, 0, 0, 0.2, 0, 0.2};
const std::vector<double> kBowedToTheFloor{0, 1.5, 0, 1.3, 0, 0};
const std::vector<double> kFoldedIntoItself{0, 0, 0, 3.0, 0, 0};

struct Rules {
  PlanningSettings settings;
  std::vector<std::vector<double>> seen;
  bool allow(const std::vector<double>& posture) const {
    return PostureRules(test_arm(), true_T_base_sensor(), seen, settings).allow(posture);
  }
};

TEST(PostureRules, AllowAnUprightPosture) { EXPECT_TRUE(Rules().allow(kUpright)); }

TEST(PostureRules, ForbidWhatReachesBelowTheTable) {
  Rules rules;
  EXPECT_FALSE(rules.allow(kBowedToTheFloor));
  rules.settings.min_height_m = -2;
  EXPECT_TRUE(rules.allow(kBowedToTheFloor));
}

TEST(PostureRules, ForbidLinksThatMeet) {
  Rules rules;
  EXPECT_FALSE(rules.allow(kFoldedIntoItself));
  rules.settings.self_clearance_m = -1;
  EXPECT_TRUE(rules.allow(kFoldedIntoItself));
}

TEST(PostureRules, ForbidWhatLeavesTheWorkspace) {
  Rules rules;
  rules.settings.workspace_base = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, 1, 2));
  EXPECT_TRUE(rules.allow(kUpright));
  rules.settings.workspace_base->max().z() = 0.6;
  EXPECT_FALSE(rules.allow(kUpright));
}

TEST(PostureRules, ForbidWhatComesCloseToTheSensor) {
  Rules rules;
  rules.settings.min_range_m = 1.2;
  EXPECT_TRUE(rules.allow(kUpright));
  rules.settings.min_range_m = 1.8;
  EXPECT_FALSE(rules.allow(kUpright));
}

TEST(PostureRules, ForbidWhatWasSeenBefore) {
  Rules rules;
  auto close = kUpright;
  close[2] += 0.1;
  rules.seen = {close};
  EXPECT_FALSE(rules.allow(kUpright));
  rules.seen[0][2] += 0.1;
  EXPECT_TRUE(rules.allow(kUpright));
}

}  // namespace
}  // namespace calibrd
