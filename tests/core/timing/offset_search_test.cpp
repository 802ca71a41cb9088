// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/offset_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

std::vector<double> misfits(const OffsetSearch& search, double truth_s) {
  std::vector<double> values;
  for (const double candidate : search.candidates_s())
    values.push_back(0.02 + std::min(0.5, 20 * std::abs(candidate - truth_s)));
  return values;
}

TEST(OffsetSearch, FindsTheCandidateNextToTheTruth) {
  OffsetSearch search;
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(search.found_s());
    search.add(misfits(search, 0.083));
  }
  ASSERT_TRUE(search.found_s());
  EXPECT_NEAR(*search.found_s(), 0.083, 0.011);
}

TEST(OffsetSearch, SaysNothingWhereAllCandidatesFitAlike) {
  OffsetSearch search;
  for (int i = 0; i < 100; ++i) search.add(std::vector<double>(search.candidates_s().size(), 0.3));
  EXPECT_FALSE(search.found_s());
}

}  // namespace
}  // namespace calibrd
