// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "drivers/sensor/child/device_choice.hpp"
#include "drivers/sensor/child/video_mode.hpp"

namespace calibrd {
namespace {

TEST(DeviceChoice, EmptyTakesTheFirst) {
  EXPECT_TRUE(DeviceChoice("").admits_uri("anything"));
  EXPECT_TRUE(DeviceChoice("").admits_serial("anything"));
}

TEST(DeviceChoice, UriIsExactEvenWithAQuestionMark) {
  const DeviceChoice choice("freenect2://0?serial=12");
  EXPECT_TRUE(choice.admits_uri("freenect2://0?serial=12"));
  EXPECT_FALSE(choice.admits_uri("freenect2://0Xserial=12"));
  EXPECT_FALSE(choice.admits_uri("freenect2://0?serial=123"));
  EXPECT_EQ(choice.exact_uri(), "freenect2://0?serial=12");
}

TEST(DeviceChoice, PatternSpansSlashes) {
  const DeviceChoice choice("1d27/*");
  EXPECT_TRUE(choice.admits_uri("1d27/0601@1/5"));
  EXPECT_FALSE(choice.admits_uri("2bc5/0601@1/5"));
  EXPECT_FALSE(choice.exact_uri());
}

TEST(DeviceChoice, SerialIsAskedOfEveryDevice) {
  const DeviceChoice choice("serial:0123");
  EXPECT_TRUE(choice.admits_uri("anything"));
  EXPECT_TRUE(choice.admits_serial("0123"));
  EXPECT_FALSE(choice.admits_serial("01234"));
  EXPECT_FALSE(choice.admits_serial(""));
}

constexpr std::array kOffers{
    VideoMode{PixelFormat::depth_1_mm, 640, 480, 30}, VideoMode{PixelFormat::depth_100_um, 512, 424, 30},
    VideoMode{PixelFormat::depth_1_mm, 512, 424, 15}, VideoMode{PixelFormat::depth_1_mm, 512, 424, 30}};
constexpr std::array kMillimetresFirst{PixelFormat::depth_1_mm, PixelFormat::depth_100_um};
constexpr std::array kFineFirst{PixelFormat::depth_100_um, PixelFormat::depth_1_mm};

TEST(VideoModeChoice, TakesTheSizeAskedForNotTheDefault) {
  EXPECT_EQ(choose_mode(kOffers, 512, 424, 30, kMillimetresFirst), kOffers[3]);
}

TEST(VideoModeChoice, PrefersTheFirstFormat) {
  EXPECT_EQ(choose_mode(kOffers, 512, 424, 30, kFineFirst), kOffers[1]);
  EXPECT_EQ(choose_mode(kOffers, 640, 480, 30, kFineFirst), kOffers[0]);
}

TEST(VideoModeChoice, TakesTheHighestRateWhenAnyWillDo) {
  EXPECT_EQ(choose_mode(kOffers, 512, 424, 0, kMillimetresFirst), kOffers[3]);
  EXPECT_EQ(choose_mode(kOffers, 512, 424, 15, kMillimetresFirst), kOffers[2]);
}

TEST(VideoModeChoice, FindsNothingWhereNothingFits) {
  EXPECT_FALSE(choose_mode(kOffers, 320, 240, 30, kMillimetresFirst));
  EXPECT_FALSE(choose_mode(kOffers, 512, 424, 60, kMillimetresFirst));
  EXPECT_EQ(describe({}), "none");
}

}  // namespace
}  // namespace calibrd
