// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/frame_pairing.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using Pairing = FramePairing<int, int>;

constexpr auto kPeriod = 33333us;
constexpr Pairing::Clock::time_point kStart(1h);

/// The moment of frame `index` of a 30 Hz device, `late_us` after its time.
Moment moment(int index, std::int64_t late_us = 0) {
  return {index, static_cast<std::uint64_t>(1'000'000 + index * 33333 + late_us)};
}

TEST(FramePairing, PairsWhateverComesFirst) {
  Pairing pairing(true, kPeriod);
  pairing.add_depth(1, moment(1), kStart);
  EXPECT_FALSE(pairing.next(kStart));
  pairing.add_image(1, moment(1));
  auto pair = pairing.next(kStart);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->image, 1);

  pairing.add_image(2, moment(2));
  pairing.add_depth(2, moment(2), kStart);
  pair = pairing.next(kStart);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->image, 2);
}

TEST(FramePairing, PairsWithinHalfAPeriod) {
  for (const std::int64_t late_us : {-16666, 16666}) {
    Pairing pairing(true, kPeriod);
    pairing.add_image(7, moment(5, late_us));
    pairing.add_depth(5, moment(5), kStart);
    EXPECT_EQ(pairing.next(kStart)->image, 7) << late_us;
  }
}

TEST(FramePairing, DoesNotPairFurtherApart) {
  Pairing pairing(true, kPeriod);
  pairing.add_image(7, moment(5, -16667));
  pairing.add_depth(5, moment(5), kStart);
  EXPECT_FALSE(pairing.next(kStart)) << "its own image may still come";
  EXPECT_FALSE(pairing.next(kStart + kPeriod)->image);
}

TEST(FramePairing, TakesTheNearestImage) {
  Pairing pairing(true, kPeriod);
  pairing.add_image(1, moment(5, -15000));
  pairing.add_image(2, moment(5, 1000));
  pairing.add_image(3, moment(5, 15000));
  pairing.add_depth(5, moment(5), kStart);
  EXPECT_EQ(pairing.next(kStart)->image, 2);
}

TEST(FramePairing, WaitsNoLongerThanOnePeriod) {
  Pairing pairing(true, kPeriod);
  pairing.add_depth(1, moment(1), kStart);
  EXPECT_EQ(pairing.deadline(), kStart + kPeriod);
  EXPECT_FALSE(pairing.next(kStart + kPeriod - 1us));
  const auto pair = pairing.next(kStart + kPeriod);
  ASSERT_TRUE(pair);
  EXPECT_FALSE(pair->image);
  EXPECT_FALSE(pairing.deadline());
}

TEST(FramePairing, DoesNotWaitWhenTheNextDepthFrameIsThere) {
  Pairing pairing(true, kPeriod);
  pairing.add_depth(1, moment(1), kStart);
  pairing.add_depth(2, moment(2), kStart);
  const auto pair = pairing.next(kStart);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->depth, 1);
  EXPECT_FALSE(pairing.next(kStart));
}

TEST(FramePairing, DoesNotWaitForAnImageThatWasLost) {
  Pairing pairing(true, kPeriod);
  pairing.add_depth(1, moment(1), kStart);
  pairing.add_image(2, moment(2));
  const auto pair = pairing.next(kStart);
  ASSERT_TRUE(pair);
  EXPECT_FALSE(pair->image);
  pairing.add_depth(2, moment(2), kStart);
  EXPECT_EQ(pairing.next(kStart)->image, 2) << "the image is kept for its own frame";
}

TEST(FramePairing, NeverWaitsWithoutAnImageStream) {
  Pairing pairing(false, kPeriod);
  pairing.add_depth(1, moment(1), kStart);
  EXPECT_TRUE(pairing.next(kStart));
}

TEST(FramePairing, PairsByIndexWhereThereAreNoTimestamps) {
  Pairing pairing(true, kPeriod);
  pairing.add_image(3, {3, 0});
  pairing.add_image(4, {4, 0});
  pairing.add_depth(4, {4, 0}, kStart);
  EXPECT_EQ(pairing.next(kStart)->image, 4);
}

TEST(FramePairing, UsesNoImageTwice) {
  Pairing pairing(true, kPeriod);
  pairing.add_image(1, moment(1));
  pairing.add_depth(1, moment(1), kStart);
  pairing.add_depth(2, moment(1, 100), kStart);
  EXPECT_TRUE(pairing.next(kStart)->image);
  EXPECT_FALSE(pairing.next(kStart + kPeriod)->image);
}

}  // namespace
}  // namespace calibrd
