// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/core/capture/recording.hpp"
#include "tests/core/capture/test_png.hpp"

namespace calibrd {
namespace {

using namespace test;
namespace fs = std::filesystem;

TEST(ReadCapture, ReadsEveryKey) {
  const Recording recording;
  const auto capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->note, "by hand");
  EXPECT_EQ(capture->urdf, recording.path("robot.urdf"));
  EXPECT_EQ(capture->base_link, "base");
  EXPECT_EQ(capture->joint_names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(capture->sensor_id, "s");
  EXPECT_EQ(capture->camera.width, 8);
  EXPECT_EQ(capture->camera.fx, 10);
  EXPECT_EQ(capture->camera.fy, 11.5);
  EXPECT_EQ(capture->camera.cx, 3.5);
  EXPECT_EQ(capture->camera.cy, 4);
  EXPECT_FALSE(capture->camera.is_distorted());
  ASSERT_EQ(capture->views.size(), 1U);
  const View& view = capture->views[0];
  EXPECT_EQ(view.depth.raw, counting(64, 1000, 3));
  EXPECT_NEAR(view.depth.depth_m(1, 0), 1.003, 1e-12);
  ASSERT_TRUE(view.image);
  EXPECT_EQ(view.image->pixels, counting(64, 20, 3));
  EXPECT_EQ(view.joint_positions_rad, (std::vector{0.5, -1.0}));
  EXPECT_EQ(view.stamp_s, 2.5);
}

TEST(ReadCapture, OptionalKeysMayBeAbsent) {
  Recording recording;
  recording.change("\"note\": \"by hand\",", "");
  recording.change("\"base_link\": \"base\", ", "");
  recording.change("\"id\": \"s\", ", "");
  recording.change("\"image\": \"image.png\", ", "");
  recording.change(", \"stamp_s\": 2.5", "");
  const auto capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_TRUE(capture->note.empty());
  EXPECT_TRUE(capture->base_link.empty());
  EXPECT_FALSE(capture->views[0].image);
}

TEST(ReadCapture, ImagesThatAreToBeIgnoredAreNotRead) {
  Recording recording;
  recording.folder().write("image.png", "garbled");
  EXPECT_FALSE(recording.read());
  const auto with_garbled = read_capture(recording.path(), {}, CaptureImages::ignore);
  ASSERT_TRUE(with_garbled) << with_garbled.error().message();
  EXPECT_FALSE(with_garbled->views[0].image);
  EXPECT_EQ(with_garbled->views[0].depth.raw, counting(64, 1000, 3));
  recording.change("\"image.png\"", "\"none.png\"");
  EXPECT_TRUE(read_capture(recording.path(), {}, CaptureImages::ignore));
  recording.folder().write("depth.png", "garbled");
  EXPECT_FALSE(read_capture(recording.path(), {}, CaptureImages::ignore));
}

TEST(ReadCapture, UnknownKeysAreIgnored) {
  Recording recording;
  recording.change("\"note\"", "\"made_by\": {\"tool\": [1, null, true]}, \"note\"");
  recording.change("\"width\"", "\"serial\": 5, \"width\"");
  recording.change("\"depth\"", "\"exposure_us\": 5, \"depth\"");
  EXPECT_TRUE(recording.read());
}

TEST(ReadCapture, ReadsTheFiveDistortionCoefficientsInOpenCvOrder) {
  Recording recording;
  recording.change("\"cy\": 4", "\"cy\": 4, \"distortion\": [0.09, -0.27, 0.001, -0.002, 0.095]");
  const auto capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->camera.distortion, (std::array<double, 5>{0.09, -0.27, 0.001, -0.002, 0.095}));
}

TEST(ReadCapture, ByteOrderMarkOfAnEditorIsSkipped) {
  const Recording recording;
  recording.folder().write("capture.json", "\xEF\xBB\xBF" + good_document());
  EXPECT_TRUE(recording.read());
}

TEST(ReadCapture, ColourAndEightBitImagesAreReadAsGrey) {
  const Recording recording;
  recording.folder().write("image.png",
                           png_of(8, 8, SPNG_COLOR_TYPE_TRUECOLOR, 8, std::vector<unsigned char>(192, 50)));
  auto capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->views[0].image->pixels, std::vector<std::uint16_t>(64, 50));
  recording.folder().write("image.png",
                           png_of(8, 8, SPNG_COLOR_TYPE_GRAYSCALE, 8, std::vector<unsigned char>(64, 60)));
  capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->views[0].image->pixels, std::vector<std::uint16_t>(64, 60));
}

TEST(ReadCapture, ImagesMayLieInFoldersOfTheRecording) {
  Recording recording;
  fs::create_directories(recording.path("frames/a"));
  fs::rename(recording.path("depth.png"), recording.path("frames/a/depth..png"));
  recording.change("depth.png", "frames/./a/depth..png");
  EXPECT_TRUE(recording.read());
}

TEST(ReadCapture, PrincipalPointOfACroppedImageMayLieOutside) {
  Recording recording;
  recording.change("\"cx\": 3.5", "\"cx\": -5");
  EXPECT_TRUE(recording.read());
}

TEST(ReadCapture, ExampleOfTheDocumentationIsReadable) {
  std::ifstream page(fs::path(CALIBRD_DOCS_DIR) / "capture.md");
  const std::string text((std::istreambuf_iterator<char>(page)), std::istreambuf_iterator<char>());
  const auto begin = text.find("```json\n") + 8, end = text.find("```", begin);
  ASSERT_NE(end, std::string::npos);
  const Recording recording;
  recording.folder().write("capture.json", text.substr(begin, end - begin));
  for (const char* image : {"depth_000.png", "depth_001.png", "image_000.png", "image_001.png"})
    recording.put_image(image, 500, 512, 424);
  const auto capture = recording.read();
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->views.size(), 2U);
}

// ---- where the URDF is looked for

/// A recording without a URDF of its own, and a folder of models: MODELS/arm_support/urdf/arm.urdf.
struct WithModels {
  WithModels() {
    fs::remove(recording.path("robot.urdf"));
    models.write("arm_support/urdf/arm.urdf", "<robot name='arm'/>");
  }
  Result<Capture> read(const std::string& urdf, const std::vector<fs::path>& folders) {
    recording.change(urdf_, urdf);
    urdf_ = urdf;
    return recording.read(folders);
  }
  fs::path urdf() const { return models.path() / "arm_support/urdf/arm.urdf"; }

  Recording recording;
  ScratchFolder models;

 private:
  std::string urdf_ = "robot.urdf";
};

void expect_found(const Result<Capture>& capture, const fs::path& urdf) {
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_TRUE(fs::equivalent(capture->urdf, urdf)) << capture->urdf;
}

TEST(ReadCaptureUrdf, IsFoundInAModelsFolder) {
  WithModels w;
  const ScratchFolder other;
  expect_found(w.read("arm_support/urdf/arm.urdf", {other.path(), w.models.path()}), w.urdf());
}

TEST(ReadCaptureUrdf, TheRecordingsOwnComesFirst) {
  WithModels w;
  const auto own = w.recording.folder().write("arm_support/urdf/arm.urdf", "<robot name='own'/>");
  expect_found(w.read("arm_support/urdf/arm.urdf", {w.models.path()}), own);
}

TEST(ReadCaptureUrdf, PackagePathIsFoundInAModelsFolder) {
  WithModels w;
  expect_found(w.read("package://arm_support/urdf/arm.urdf", {w.models.path()}), w.urdf());
}

TEST(ReadCaptureUrdf, PackagesOwnFolderServesAsModelsFolder) {
  WithModels w;
  const fs::path own = w.models.path() / "arm_support";
  expect_found(w.read("package://arm_support/urdf/arm.urdf", {own}), w.urdf());
  expect_found(w.read("arm_support/urdf/arm.urdf", {own}), w.urdf());
  expect_found(w.read("arm_support/urdf/arm.urdf", {own / ""}), w.urdf());  // with a slash at its end
  expect_found(w.read("arm_support/urdf/arm.urdf", {own / "urdf" / ".."}), w.urdf());
}

TEST(ReadCaptureUrdf, AbsolutePathIsTakenAsItIs) {
  WithModels w;
  expect_found(w.read(w.urdf().string(), {}), w.urdf());
}

TEST(ReadCaptureUrdf, WithoutItsModelsFolderIsNotFound) {
  WithModels w;
  const auto capture = w.read("arm_support/urdf/arm.urdf", {});
  ASSERT_FALSE(capture);
  EXPECT_EQ(capture.error().code, make_error_code(CaptureError::urdf_not_found));
  EXPECT_NE(capture.error().message().find("--models"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
