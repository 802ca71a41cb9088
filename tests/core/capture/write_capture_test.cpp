// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/core/capture/recording.hpp"

namespace calibrd {
namespace {

using namespace test;
namespace fs = std::filesystem;

View example_view(unsigned seed, bool with_image) {
  View view;
  view.depth = {13, 9, 0.00025, counting(13 * 9, 65535 - seed, 997)};
  if (with_image) view.image = GreyImage{13, 9, counting(13 * 9, seed, 311)};
  view.joint_positions_rad = {std::numbers::pi / (1 + seed), -1.0 / 3.0, 1e-17};
  view.stamp_s = 1.7e9 + 0.1 * seed;
  return view;
}

Capture example() {
  Capture capture;
  capture.note = "line\n\"quoted\" \xC3\xA4";
  capture.base_link = "base_link";
  capture.joint_names = {"j1", "j \"2\"", "j3"};
  capture.sensor_id = "kinect2";
  capture.camera = {13, 9, 365.456, 365.456, 6.1, 4.7, {0.0905, -0.268, 1e-3, -5e-4, 0.0951}};
  capture.views = {example_view(0, true), example_view(1, false), example_view(2, true)};
  return capture;
}

std::vector<std::string> content(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

void expect_code(const Status& status, CaptureError code) {
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, make_error_code(code)) << status.error().message();
}

TEST(WriteCapture, WhatIsWrittenIsReadBack) {
  const ScratchFolder folder;
  const Capture before = example();
  const auto status = write_capture(folder.path() / "a/b/recording", before, "robot.urdf");
  ASSERT_TRUE(status) << status.error().message();
  folder.write("a/b/recording/robot.urdf", "<robot name='r'/>");

  const auto after = read_capture(folder.path() / "a/b/recording", {});
  ASSERT_TRUE(after) << after.error().message();
  EXPECT_EQ(after->note, before.note);
  EXPECT_EQ(after->base_link, before.base_link);
  EXPECT_EQ(after->joint_names, before.joint_names);
  EXPECT_EQ(after->sensor_id, before.sensor_id);
  EXPECT_EQ(after->camera.width, 13);
  EXPECT_EQ(after->camera.height, 9);
  EXPECT_DOUBLE_EQ(after->camera.fx, before.camera.fx);
  EXPECT_DOUBLE_EQ(after->camera.fy, before.camera.fy);
  EXPECT_DOUBLE_EQ(after->camera.cx, before.camera.cx);
  EXPECT_DOUBLE_EQ(after->camera.cy, before.camera.cy);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_DOUBLE_EQ(after->camera.distortion[i], before.camera.distortion[i]);
  ASSERT_EQ(after->views.size(), 3U);
  for (std::size_t v = 0; v < 3; ++v) {
    const View &wrote = before.views[v], &read = after->views[v];
    EXPECT_EQ(read.depth.raw, wrote.depth.raw);
    EXPECT_EQ(read.depth.scale_m, wrote.depth.scale_m);
    ASSERT_EQ(read.image.has_value(), wrote.image.has_value());
    if (read.image) {
      EXPECT_EQ(read.image->pixels, wrote.image->pixels);
    }
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_DOUBLE_EQ(read.joint_positions_rad[j], wrote.joint_positions_rad[j]);
    EXPECT_DOUBLE_EQ(read.stamp_s, wrote.stamp_s);
  }
}

TEST(WriteCapture, LeavesOnlyTheRecordingBehind) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_capture(folder.path() / "recording", example(), "robot.urdf"));
  EXPECT_EQ(content(folder.path()), (std::vector<std::string>{"recording"}));
  EXPECT_EQ(content(folder.path() / "recording"),
            (std::vector<std::string>{"capture.json", "depth_000.png", "depth_001.png", "depth_002.png",
                                      "image_000.png", "image_002.png"}));
}

TEST(WriteCapture, FillsAnEmptyFolderAndTakesASlashAtTheEnd) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "recording");
  const auto status = write_capture(folder.path() / "recording" / "", example(), "robot.urdf");
  ASSERT_TRUE(status) << status.error().message();
  EXPECT_TRUE(fs::exists(folder.path() / "recording/capture.json"));
}

TEST(WriteCapture, RefusesAFolderThatHoldsSomething) {
  const ScratchFolder folder;
  folder.write("recording/precious.txt", "mine");
  expect_code(write_capture(folder.path() / "recording", example(), "robot.urdf"),
              CaptureError::folder_not_empty);
  EXPECT_EQ(content(folder.path() / "recording"), (std::vector<std::string>{"precious.txt"}));
  EXPECT_EQ(content(folder.path()), (std::vector<std::string>{"recording"}));
}

TEST(WriteCapture, NeverReplacesAFile) {
  const ScratchFolder folder;
  folder.write("recording", "");  // empty, as an empty folder is
  expect_code(write_capture(folder.path() / "recording", example(), "robot.urdf"), CaptureError::unwritable);
  EXPECT_TRUE(fs::is_regular_file(folder.path() / "recording"));
  EXPECT_EQ(content(folder.path()), (std::vector<std::string>{"recording"}));
}

TEST(WriteCapture, LeavesAFolderOfASimilarNameAlone) {
  const ScratchFolder folder;
  folder.write("recording.partial0/precious.txt", "mine");
  folder.write("recording.partial/precious.txt", "mine");
  ASSERT_TRUE(write_capture(folder.path() / "recording", example(), "robot.urdf"));
  EXPECT_TRUE(fs::exists(folder.path() / "recording.partial0/precious.txt"));
  EXPECT_TRUE(fs::exists(folder.path() / "recording.partial/precious.txt"));
  EXPECT_TRUE(fs::exists(folder.path() / "recording/capture.json"));
}

TEST(WriteCapture, FolderBelowAFileIsUnwritable) {
  const ScratchFolder folder;
  folder.write("file", "x");
  expect_code(write_capture(folder.path() / "file/recording", example(), "robot.urdf"),
              CaptureError::unwritable);
}

struct BadRecording {
  const char* name;
  void (*spoil)(Capture&);
  CaptureError code;
};

void PrintTo(const BadRecording& value, std::ostream* out) { *out << value.name; }

class WriteBadCapture : public testing::TestWithParam<BadRecording> {};

TEST_P(WriteBadCapture, IsRefusedAndNothingIsLeftBehind) {
  const ScratchFolder folder;
  Capture capture = example();
  GetParam().spoil(capture);
  expect_code(write_capture(folder.path() / "recording", capture, "robot.urdf"), GetParam().code);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using enum CaptureError;
INSTANTIATE_TEST_SUITE_P(
    , WriteBadCapture,
    testing::Values(
        BadRecording{"NoView", [](Capture& c) { c.views.clear(); }, no_frames},
        BadRecording{"JointMissing", [](Capture& c) { c.views[1].joint_positions_rad.pop_back(); },
                     wrong_joint_count},
        BadRecording{"JointNotANumber", [](Capture& c) { c.views[2].joint_positions_rad[0] = kNaN; },
                     wrong_joint_count},
        BadRecording{"StampNotANumber", [](Capture& c) { c.views[2].stamp_s = kNaN; }, bad_value},
        BadRecording{"OtherDepthSize", [](Capture& c) { c.views[1].depth.width = 12; }, wrong_image_size},
        BadRecording{"OtherImageSize", [](Capture& c) { c.views[0].image->height = 10; }, wrong_image_size},
        BadRecording{"PixelMissing", [](Capture& c) { c.views[2].depth.raw.pop_back(); }, unwritable},
        BadRecording{"ImagePixelMissing", [](Capture& c) { c.views[2].image->pixels.pop_back(); },
                     unwritable},
        BadRecording{"OtherScale", [](Capture& c) { c.views[2].depth.scale_m = 0.001; }, bad_value},
        BadRecording{"NoScale",
                     [](Capture& c) {
                       for (View& v : c.views) v.depth.scale_m = 0;
                     },
                     bad_value},
        BadRecording{"NoFocalLength", [](Capture& c) { c.camera.fx = 0; }, bad_value},
        BadRecording{"CentreNotANumber", [](Capture& c) { c.camera.cx = kNaN; }, bad_value}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace calibrd
