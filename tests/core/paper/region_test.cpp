// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/region.hpp"

#include <gtest/gtest.h>

#include "core/paper/paper_error.hpp"

namespace calibrd {
namespace {

TEST(Region, IsSixNumbersBetweenCommas) {
  const auto region = parse_region("-0.5,-0.25,1,0.5,0.25,2.5");
  ASSERT_TRUE(region);
  EXPECT_EQ(region->min(), Eigen::Vector3d(-0.5, -0.25, 1));
  EXPECT_EQ(region->max(), Eigen::Vector3d(0.5, 0.25, 2.5));
}

TEST(Region, OfAnotherShapeIsRefused) {
  for (const char* text :
       {"", "1", "0,0,0,1,1", "0,0,0,1,1,1,", "0,0,0,1,1,1,1", "0,0,0,1,1,x", "0,0,0 1,1,1", "0,0,0,1,1,nan",
        "0,0,0,1,1,inf", "0,,0,1,1,1", "1,0,0,0,1,1", "0,0,0,1,1,0"}) {
    const auto region = parse_region(text);
    ASSERT_FALSE(region) << text;
    EXPECT_EQ(region.error().code, PaperError::bad_region) << text;
  }
}

}  // namespace
}  // namespace calibrd
