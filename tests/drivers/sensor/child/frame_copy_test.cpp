// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/frame_copy.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

using Pixels = std::vector<std::uint16_t>;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> result;
  for (const int value : values) result.push_back(static_cast<std::byte>(value));
  return result;
}

Pixels copied(const RawFrame& frame, bool flip = false) {
  Pixels pixels(static_cast<std::size_t>(frame.width * frame.height));
  copy_pixels(frame, flip, pixels);
  return pixels;
}

TEST(FrameCopy, TakesPackedAndPaddedRows) {
  const auto packed = bytes({1, 0, 2, 0, 3, 0, 4, 0});
  const auto padded = bytes({1, 0, 2, 0, 99, 99, 3, 0, 4, 0});  // no padding after the last row
  RawFrame frame{.format = PixelFormat::depth_1_mm, .width = 2, .height = 2, .data = packed};
  EXPECT_TRUE(check_frame(frame, PixelFormat::depth_1_mm, 2, 2));
  EXPECT_EQ(copied(frame), (Pixels{1, 2, 3, 4}));
  frame.data = padded;
  frame.stride_bytes = 6;
  EXPECT_TRUE(check_frame(frame, PixelFormat::depth_1_mm, 2, 2));
  EXPECT_EQ(copied(frame), (Pixels{1, 2, 3, 4}));
}

TEST(FrameCopy, FlipsRows) {
  const auto data = bytes({1, 0, 2, 0, 3, 0, 4, 0});
  const RawFrame frame{.format = PixelFormat::depth_1_mm, .width = 2, .height = 2, .data = data};
  EXPECT_EQ(copied(frame, true), (Pixels{2, 1, 4, 3}));
}

TEST(FrameCopy, MakesEveryFormatGrey) {
  const auto rgb = bytes({255, 255, 255, 255, 0, 0});
  EXPECT_EQ(copied({.format = PixelFormat::rgb888, .width = 2, .height = 1, .data = rgb}), (Pixels{255, 76}));
  const auto yuyv = bytes({10, 128, 20, 128});
  EXPECT_EQ(copied({.format = PixelFormat::yuyv, .width = 2, .height = 1, .data = yuyv}), (Pixels{10, 20}));
  const auto uyvy = bytes({128, 10, 128, 20});
  EXPECT_EQ(copied({.format = PixelFormat::yuv422, .width = 2, .height = 1, .data = uyvy}), (Pixels{10, 20}));
  const auto grey = bytes({10, 200});
  EXPECT_EQ(copied({.format = PixelFormat::grey8, .width = 2, .height = 1, .data = grey}), (Pixels{10, 200}));
}

TEST(FrameCopy, RefusesWhatIsNotTheFrameAskedFor) {
  const auto data = bytes({1, 0, 2, 0, 3, 0, 4, 0});
  const RawFrame good{
      .format = PixelFormat::grey16, .width = 2, .height = 2, .stride_bytes = 4, .data = data};
  ASSERT_TRUE(check_frame(good, PixelFormat::grey16, 2, 2));
  const auto expect_refused = [&](const char* what, auto change) {
    RawFrame bad = good;
    change(bad);
    const auto checked = check_frame(bad, PixelFormat::grey16, 2, 2);
    ASSERT_FALSE(checked) << what;
    EXPECT_EQ(checked.error().code, SensorError::bad_frames);
  };
  expect_refused("width", [](RawFrame& f) { f.width = 4; });
  expect_refused("height", [](RawFrame& f) { f.height = 1; });
  expect_refused("format", [](RawFrame& f) { f.format = PixelFormat::grey8; });
  expect_refused("cropped", [](RawFrame& f) { f.is_cropped = true; });
  expect_refused("overlapping rows", [](RawFrame& f) { f.stride_bytes = 3; });
  expect_refused("negative stride", [](RawFrame& f) { f.stride_bytes = -4; });
  expect_refused("stride beyond the data", [](RawFrame& f) { f.stride_bytes = 6; });
  expect_refused("too short", [](RawFrame& f) { f.data = f.data.first(7); });
  expect_refused("no data", [](RawFrame& f) { f.data = {}; });
}

}  // namespace
}  // namespace calibrd
