// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/messages/topics.hpp"

#include <gtest/gtest.h>

namespace calibrd::fleet {
namespace {

TEST(Topics, NamesHoldNothingThatMeansSomethingInATopic) {
  for (const char* good : {"cell7", "hall-3.cell_7", "A"}) EXPECT_TRUE(is_name(good)) << good;
  for (const char* bad : {"", "a/b", "+", "#", "a b", "\xc3\xa4"}) EXPECT_FALSE(is_name(bad)) << bad;
  EXPECT_FALSE(is_name(std::string(65, 'a')));
}

TEST(Topics, TheCellOfACalibrationIsReadFromItsTopic) {
  const CellTopics topics("calibrd", "cell7");
  EXPECT_EQ(topics.calibrations(), "calibrd/v1/cells/cell7/calibrations");
  EXPECT_EQ(topics.pose("kinect2"), "calibrd/v1/cells/cell7/sensors/kinect2/pose");
  EXPECT_EQ(cell_of("calibrd", topics.calibrations()), "cell7");
  EXPECT_FALSE(cell_of("other", topics.calibrations()));
  EXPECT_FALSE(cell_of("calibrd", topics.status()));
  EXPECT_FALSE(cell_of("calibrd", "calibrd/v1/cells/a/b/calibrations"));
  EXPECT_FALSE(cell_of("calibrd", "calibrd/v1/cells/calibrations"));
}

}  // namespace
}  // namespace calibrd::fleet
