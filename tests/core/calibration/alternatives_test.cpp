// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/alternatives.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace calibrd {
namespace {

const std::vector<std::string> kNames{"s", "l", "e", "u", "r", "b", "t"};

TEST(Alternatives, PutAnElbowThatWasCountedLastInItsPlace) {
  // Values of S L U R B T E, taken for S L E U R B T.
  const std::vector<std::vector<double>> mistaken{{1, 2, 4, 5, 6, 7, 3}};
  const std::vector<double> right{1, 2, 3, 4, 5, 6, 7};
  EXPECT_TRUE(std::ranges::any_of(alternatives(kNames), [&](const Alternative& alternative) {
    return alternative.reason.code == "joint_order_wrong" && alternative.joints(mistaken, 0) == right;
  }));
}

TEST(Alternatives, NoneLeavesTheInputAsItIs) {
  const std::vector<std::vector<double>> joints{{1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14}};
  const CameraModel camera{512, 424, 365, 366, 254, 205, {}};
  for (const Alternative& alternative : alternatives(kNames)) {
    const CameraModel seen_by = alternative.camera(camera);
    EXPECT_TRUE(alternative.mirrored || alternative.joints(joints, 0) != joints[0] || seen_by.cx != camera.cx)
        << alternative.reason.text;
  }
}

TEST(Alternatives, ShiftHasNoJointsBeyondTheEnds) {
  const std::vector<std::vector<double>> joints{{1}, {2}};
  for (const Alternative& alternative : alternatives({"only"})) {
    if (alternative.reason.code != "joints_not_of_frame") continue;
    const bool forward = alternative.joints(joints, 0) == joints[1];
    EXPECT_TRUE(alternative.joints(joints, forward ? 1 : 0).empty());
  }
}

}  // namespace
}  // namespace calibrd
