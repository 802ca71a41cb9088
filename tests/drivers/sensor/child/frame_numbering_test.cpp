// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/frame_numbering.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

TEST(FrameNumbering, StartsAtZeroWhateverTheDeviceSays) {
  FrameNumbering numbering;
  EXPECT_EQ(numbering.number({4711, 5}), 0u);
  EXPECT_EQ(numbering.number({4712, 6}), 1u);
}

TEST(FrameNumbering, ShowsGaps) {
  FrameNumbering numbering;
  numbering.number({1, 10});
  EXPECT_EQ(numbering.number({5, 50}), 4u);
}

TEST(FrameNumbering, DropsARepeatedFrame) {
  FrameNumbering numbering;
  numbering.number({1, 10});
  EXPECT_FALSE(numbering.number({1, 10}));
  EXPECT_EQ(numbering.number({1, 20}), 1u) << "a stuck index with a new time is a new frame";
  EXPECT_EQ(numbering.number({2, 20}), 2u) << "so is a stuck time with a new index";
}

TEST(FrameNumbering, CountsByItselfWhenTheDeviceDoesNot) {
  FrameNumbering numbering;
  for (std::uint64_t n = 0; n < 5; ++n) EXPECT_EQ(numbering.number({0, 0}), n);
}

TEST(FrameNumbering, GoesOnWhenTheIndexStartsAgain) {
  FrameNumbering numbering;
  numbering.number({100, 10});
  EXPECT_EQ(numbering.number({1, 20}), 1u);
  EXPECT_EQ(numbering.number({2, 30}), 2u);
  EXPECT_EQ(numbering.number({2000000000, 40}), 3u) << "no device loses that many";
  EXPECT_EQ(numbering.number({-2000000000, 50}), 4u);
}

}  // namespace
}  // namespace calibrd
