// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/png.hpp"

#include <gtest/gtest.h>

#include "core/capture/capture_error.hpp"
#include "tests/core/capture/test_png.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using namespace test;

PngImage written_and_read(const std::string& png) {
  const ScratchFolder folder;
  auto image = read_png(folder.write("image.png", png));
  if (!image) throw std::runtime_error(image.error().message());
  return std::move(image).value();
}

TEST(Png, SixteenBitGreyKeepsEveryValue) {
  const ScratchFolder folder;
  std::vector<std::uint16_t> all(65536);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
  ASSERT_TRUE(write_png16(folder.path() / "all.png", 256, 256, all));
  const auto image = read_png(folder.path() / "all.png");
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_EQ(image->pixels, all);
  EXPECT_EQ(image->bit_depth, 16);
  EXPECT_EQ(image->channels, 1);
}

TEST(Png, RowsStayRows) {
  const ScratchFolder folder;
  const std::vector<std::uint16_t> pixels{1, 2, 3, 400, 500, 60000};
  ASSERT_TRUE(write_png16(folder.path() / "wide.png", 3, 2, pixels));
  const auto image = read_png(folder.path() / "wide.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->pixels, pixels);
}

TEST(Png, EightBitGreyKeepsItsValues) {
  const PngImage image = written_and_read(png_of(3, 1, SPNG_COLOR_TYPE_GRAYSCALE, 8, {0, 77, 255}));
  EXPECT_EQ(image.pixels, (std::vector<std::uint16_t>{0, 77, 255}));
  EXPECT_EQ(image.bit_depth, 8);
  EXPECT_EQ(image.channels, 1);
}

TEST(Png, OneBitGreyIsBlackAndWhiteOfEightBits) {
  const PngImage image = written_and_read(png_of(4, 1, SPNG_COLOR_TYPE_GRAYSCALE, 1, {0b01010000}));
  EXPECT_EQ(image.pixels, (std::vector<std::uint16_t>{0, 255, 0, 255}));
}

TEST(Png, ColourBecomesLuminance) {
  const PngImage image = written_and_read(
      png_of(4, 1, SPNG_COLOR_TYPE_TRUECOLOR, 8, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}));
  ASSERT_EQ(image.pixels.size(), 4U);  // BT.601: 0.299, 0.587, 0.114
  EXPECT_NEAR(image.pixels[0], 76, 1);
  EXPECT_NEAR(image.pixels[1], 150, 1);
  EXPECT_NEAR(image.pixels[2], 29, 1);
  EXPECT_EQ(image.pixels[3], 255);
  EXPECT_EQ(image.bit_depth, 8);
  EXPECT_EQ(image.channels, 3);
}

TEST(Png, SixteenBitColourKeepsItsRange) {
  const PngImage image = written_and_read(
      png_of(2, 1, SPNG_COLOR_TYPE_TRUECOLOR, 16, samples16({1000, 1000, 1000, 0, 60000, 0})));
  EXPECT_EQ(image.pixels[0], 1000);
  EXPECT_NEAR(image.pixels[1], 35220, 1);
}

TEST(Png, AlphaIsDropped) {
  const PngImage image =
      written_and_read(png_of(2, 1, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 8, {90, 90, 90, 0, 10, 10, 10, 255}));
  EXPECT_EQ(image.pixels, (std::vector<std::uint16_t>{90, 10}));
}

TEST(Png, InterlacedImageIsReadInOrder) {
  std::vector<std::uint16_t> pixels(15 * 11);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint16_t>(300 * i);
  EXPECT_EQ(written_and_read(png_of(15, 11, SPNG_COLOR_TYPE_GRAYSCALE, 16, samples16(pixels), true)).pixels,
            pixels);
}

TEST(Png, AnyBytesGiveAnErrorNotACrash) {
  const ScratchFolder folder;
  for (const std::string& bytes : {std::string(), std::string("\x89PNG\r\n\x1a\n"), std::string(5000, 'x')}) {
    const auto image = read_png(folder.write("image.png", bytes));
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, make_error_code(CaptureError::bad_png));
  }
}

TEST(Png, PixelsThatDoNotFillTheImageAreNotWritten) {
  const ScratchFolder folder;
  const auto status = write_png16(folder.path() / "short.png", 4, 4, std::vector<std::uint16_t>(15));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, make_error_code(CaptureError::unwritable));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "short.png"));
}

TEST(Png, MissingFolderIsUnwritable) {
  const ScratchFolder folder;
  const auto status = write_png16(folder.path() / "nowhere" / "a.png", 1, 1, std::vector<std::uint16_t>(1));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, make_error_code(CaptureError::unwritable));
}

}  // namespace
}  // namespace calibrd
